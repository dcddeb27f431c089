"""Whether a file is a stream; Rerun's own `rerun rrd verify` lets empty files pass."""

import warnings
from pathlib import Path

from rerun.chunk import RrdReader

from tsas_cli.support.errors import InputError


def is_finished(path: Path) -> bool:
    """Return whether a stream was written to its end; what it holds can be shown without, too.

    Only the heads of its parts are read, however large it is.

    Raises
    ------
    InputError
        It is no stream, holds none, or is cut off within a part.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # says that a stream has no end, which is returned here
            reader = RrdReader(path)
            found = reader.recordings()
    except (RuntimeError, ValueError, OSError) as error:
        reason = str(error).splitlines()[0].removeprefix(f"Failed to read RRD file at {path}: ")
        raise InputError(
            f"cannot be shown ({reason.removeprefix('Failed to decode frame: ')})",
            where=path,
            expected="a whole .rrd file, or the folder of a stage",
        ) from error
    if not found:
        raise InputError("holds no recording", where=path, expected="a stream that tsas wrote")
    try:
        reader.store(store=found[0])
    except RuntimeError:
        return False
    return True
