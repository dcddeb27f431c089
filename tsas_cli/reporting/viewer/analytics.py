"""What a person should know before the viewer starts: it counts how it is used."""

import os
from contextlib import suppress
from pathlib import Path

NOTE = (
    "the viewer is Rerun's; its window sends Rerun usage statistics, never data, until you run "
    "`rerun analytics disable`; in the browser tsas keeps it from calling anyone (said once)"
)


def note_once() -> str:
    """Return the note the first time that a user is about to start the viewer, then nothing.

    Where nothing can be remembered it is returned each time.
    """
    import platformdirs

    root = os.environ.get("TSAS_STATE_DIR") or platformdirs.user_state_dir("tsas")
    marker = Path(root) / "viewer-analytics-said"
    if marker.exists():
        return ""
    with suppress(OSError):
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.touch()
    return NOTE
