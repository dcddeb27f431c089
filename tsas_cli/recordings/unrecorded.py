"""What a dataset cannot show, since a channel is in none or in some of its runs only."""

from collections.abc import Container, Iterator, Sequence

_SHOWN_BY = {
    "x_in_mm": "the stiffness of the tendon, motion lost at the drive and errors of the proximal "
    "position sensor cannot be judged",
    "x_out_mm": "motion lost at the load and errors of the distal position sensor cannot be judged",
    "f_in_N": "the level of friction rests on the stiffness of the tendon, and errors of the "
    "proximal force sensor cannot be judged",
    "f_out_N": "the tension at the load rests on its stiffness, and errors of the distal force "
    "sensor cannot be judged",
}


def unrecorded(columns: Sequence[Container[str]]) -> Iterator[str]:
    """Yield a sentence for each missing displacement or tension: what cannot be judged without it.

    `columns` holds the names of those that each run has.
    """
    for name, cannot in _SHOWN_BY.items():
        without = sum(name not in names for names in columns)
        if without:
            where = "" if without == len(columns) else f" in {without} of {len(columns)} runs"
            yield f"{name.rpartition('_')[0]} is not recorded{where}: without it, {cannot}."
