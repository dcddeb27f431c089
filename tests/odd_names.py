"""Names of files and folders that are code to a shell or to make, and whether one was run."""

import os
from pathlib import Path

from hypothesis import strategies as st

RAN = "ran"  # the file that each piece of code leaves where it is run
CODE = (
    f";>{RAN};",
    f"';>{RAN};'",
    f'";>{RAN};"',
    f"$(>{RAN})",
    f"`>{RAN}`",
    f"'$(>{RAN})'",
    f"|>{RAN}|",
    f"&>{RAN}&",
    f"\n>{RAN}\n",
    f"\n\t>{RAN}\n",
    f"$(shell >{RAN})",
    f"$(eval x:=$(shell >{RAN}))",
    f"$$(>{RAN})",
    f": ;>{RAN};",
    f"a.csv;>{RAN};",
)
SIGNS = "'\"`$#%:=;|&~!*?[](){}<>\\^@,+- \t\n\r\v\f\x1b\x7f"
WORDS = (
    "a",
    "rec 1",
    ".csv",
    "raw",
    "-exec",
    "-delete",
    "--out",
    "$x",
    "$(OUT)",
    "ü",
    "频",
    "\udcff",
)
PIECES = st.sampled_from((*CODE, *SIGNS, *WORDS))


def odd_names(end: str = "") -> st.SearchStrategy[str]:
    """Draw names that a file can have; those with an end have nothing before it that hides them."""
    drawn = st.lists(PIECES, min_size=1, max_size=6).map(lambda pieces: "".join(pieces) + end)
    return drawn.filter(lambda name: name not in {".", ".."} and len(os.fsencode(name)) < 200)


def nothing_ran(*folders: Path) -> bool:
    """Say whether no piece of code was run that stood in a name."""
    return not [path for folder in folders for path in folder.rglob(RAN)]
