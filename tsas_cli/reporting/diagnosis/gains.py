"""The error on held-out data before and after, beside what noise and the best model leave."""

from functools import partial

from tsas_cli.records.diagnosis import Diagnosis, HeldOut
from tsas_cli.reporting.channels import called
from tsas_cli.reporting.content import Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.gains import draw_gains, height_in
from tsas_cli.reporting.numbers import ABSENT, plain

_BOUNDS = (
    "Noise alone leaves the noise floor. Best obtainable is what a flexible regression on the "
    "recorded signals leaves, whatever the cause."
)


def part(diagnosis: Diagnosis) -> Section | None:
    """Return the part, None where no channel was judged."""
    if not diagnosis.channels:
        return None
    named = bool(diagnosis.named)
    alt = "; ".join(_in_words(name, c, named=named) for name, c in diagnosis.channels.items())
    shown = picture(
        partial(draw_gains, channels=diagnosis.channels, named=named),
        key="diagnosis-gains",
        alt=f"Root mean square error on held-out data. {alt}.",
        caption="Root mean square error on held-out data, by channel.",
        height_in=height_in(len(diagnosis.channels)),
    )
    return Section(
        "diagnosis-gains",
        "Error on held-out data" + (", before and after" if named else ""),
        tuple(text for text in (_judged(diagnosis), _BOUNDS) if text),
        tables=(table(diagnosis),),
        pictures=(shown,),
    )


def _judged(diagnosis: Diagnosis) -> str:
    how = diagnosis.evidence.sentence
    return how[:1].upper() + how[1:]


def table(diagnosis: Diagnosis) -> Table:
    """Return the errors in numbers."""
    named = bool(diagnosis.named)
    rows = tuple(
        (
            name,
            plain(c.rmse_before, 3),
            plain(c.rmse_after, 3) if named else ABSENT,
            plain(c.best_obtainable, 3),
            plain(c.noise_floor, 3),
            c.unit,
        )
        for name, c in diagnosis.channels.items()
    )
    first = "before" if named else "nominal model"
    header = ("channel", first, "with what is named", "best obtainable", "noise floor", "unit")
    caption = "Root mean square error on held-out data"
    return Table(caption, header, rows, numeric=frozenset(range(1, 5))).without_empty()


def _in_words(name: str, channel: HeldOut, *, named: bool) -> str:
    first = "before" if named else "nominal model"
    after = f", with what is named {plain(channel.rmse_after, 3)}" if named else ""
    return (
        f"{called(name)}: {first} {plain(channel.rmse_before, 3)}"
        f"{after}, best obtainable {plain(channel.best_obtainable, 3)}, noise floor "
        f"{plain(channel.noise_floor, 3)} {channel.unit}"
    )
