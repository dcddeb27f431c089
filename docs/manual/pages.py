"""Which pages the site has, in which order, and where each comes from."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Page:
    """A page of the repository: its name in the contents, where it is, and where in the site."""

    title: str
    source: str
    site: str


def _docs(title: str, name: str) -> Page:
    return Page(title, f"docs/{name}.md", f"{name}.md")


HOME = _docs("Home", "index")
TUTORIAL = _docs("Tutorial", "tutorial")
HOW_TO = (
    _docs("Read your files", "files"),
    _docs("The map, key by key", "ingest"),
    _docs("A project of your own", "init"),
    _docs("Check recordings", "check"),
    _docs("Plan runs", "plan"),
    _docs("Identify a drive", "drive"),
    _docs("Track a force", "tracking"),
    _docs("Close the loop", "close-loop"),
    _docs("Many runs: sweeps", "sweep"),
    _docs("Find runs among many datasets", "runs"),
    _docs("Datasets on object storage", "object-storage"),
    _docs("A model for other programs", "export"),
)
PYTHON = _docs("From Python", "python")
FORMATS = _docs("File formats", "formats")
UNTRUSTED = _docs("Files that you don't trust", "untrusted")
METHOD = (
    _docs("How a diagnosis comes about", "diagnosis"),
    _docs("The blind benchmark", "challenge"),
    _docs("Public measurements", "measured"),
    _docs("The dynamic model", "lugre"),
    _docs("The source paper", "paper"),
    _docs("Scale", "scale"),
    Page("Data: paper-groups", "datasets/paper-groups/README.md", "data/paper-groups.md"),
    Page("Data: drive-chirp", "datasets/drive-chirp/README.md", "data/drive-chirp.md"),
    Page("Data: yang2025", "datasets/yang2025/README.md", "data/yang2025.md"),
)
LIMITS = _docs("What it can't do", "limits")
PROJECT = (
    Page("Changelog", "CHANGELOG.md", "changelog.md"),
    Page("Contributing", "CONTRIBUTING.md", "contributing.md"),
    _docs("Bad input, searched for", "fuzzing"),
    _docs("Do the tests notice?", "mutants"),
)
LEFT_OUT = {"docs/worklog.md"}  # for those who build it


def pages() -> tuple[Page, ...]:
    """Return every page of the repository that is in the site."""
    return (HOME, TUTORIAL, *how_to(), PYTHON, FORMATS, UNTRUSTED, *METHOD, LIMITS, *PROJECT)


def how_to() -> tuple[Page, ...]:
    """Return the how-to pages: those named above, then whatever else docs/ holds."""
    named = (HOME, TUTORIAL, *HOW_TO, PYTHON, FORMATS, *METHOD, LIMITS)
    others = {f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")}
    others -= LEFT_OUT | {page.source for page in named}
    return (*HOW_TO, *(_docs(title_of(ROOT / p), Path(p).stem) for p in sorted(others)))


def title_of(path: Path) -> str:
    """Return the first heading of a page."""
    found = re.search(r"^# (.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return found[1] if found else path.stem
