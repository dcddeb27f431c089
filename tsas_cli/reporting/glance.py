"""The first screen of the page: the answer in a few words, and the numbers that it rests on."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from statistics import median

from tsas_cli.records.base import span_text
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.diagnosis import VERDICTS, DiagnosisFile, HeldOut, NamedCause
from tsas_cli.records.drive import DriveDiagnosis, DriveFile
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackedResult, TrackingFile
from tsas_cli.reporting import before_after
from tsas_cli.reporting.content import Fact, Glance
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import heading_of, in_words, title_of, within
from tsas_cli.reporting.numbers import ABSENT, plain, with_interval
from tsas_cli.support.wording import listed

_REDUCTION = "normalised residual"
_NO_CAUSE = {
    "sufficient": "The nominal model explains these recordings",
    "described": "A law of unnamed origin predicts better",
    "stand_in": "No known effect explains what the model misses",
    "unexplained": "No known effect explains what the model misses",
    "undecided": "These recordings lead to no verdict",
}
_FAULT = "A fault of the recordings explains what the model misses"


def glance(inputs: Inputs) -> Glance | None:
    """Return the first screen, None where there are only recordings."""
    if closing := inputs.get(ClosingFile):
        return _of_closing(closing)
    if tracking := inputs.get(TrackingFile):
        return _of_tracking(tracking)
    if diagnosis := inputs.get(DiagnosisFile):
        found = _of_diagnosis(diagnosis, inputs.held_out)
        return replace(found, pictures=before_after.pictures(inputs))
    if prediction := inputs.get(PredictionFile):
        best, _, _ = next(iter(prediction.findings), "").partition(";")
        facts = tuple(Fact(f"model {one.name}", one.path) for one in prediction.models)
        return Glance("Predicted, not fitted", best, facts=facts)
    if drive := inputs.get(DriveFile):
        return _of_diagnosis(drive.diagnosis, drive.diagnosis.channels)
    if simulation := inputs.get(SimulationFile):
        return _of_simulation(simulation)
    return None


def _of_diagnosis(
    diagnosis: DiagnosisFile | DriveDiagnosis, channels: Mapping[str, HeldOut]
) -> Glance:
    named = diagnosis.named
    reason = diagnosis.reason[:1].upper() + diagnosis.reason[1:].rstrip(".")
    verdict = _NO_CAUSE.get(diagnosis.verdict, reason)
    if named:
        first, *more = map(heading_of, named)
        verdict = listed([first, *map(within, more)])
    if isinstance(diagnosis, DiagnosisFile) and diagnosis.faults:
        verdict = _FAULT
    numbers = "RMS of the residual on held-out data"
    extended = diagnosis.extended if isinstance(diagnosis, DiagnosisFile) else bool(named)
    facts = (*_gains(named), *_errors(channels, extended=extended))
    shown = tuple(fact for fact in facts if ABSENT not in fact.value)
    if extended:
        numbers += ", nominal → extended model"
    kind = VERDICTS[diagnosis.verdict]
    if len(named) == 1 and shown and shown[0].label == _REDUCTION:
        kind += f": {_REDUCTION} on held-out data {shown[0].value}"
    numbers = numbers if shown else ""
    return Glance(kind, verdict, numbers, shown, next_experiment=diagnosis.next_experiment)


def _errors(channels: Mapping[str, HeldOut], *, extended: bool) -> Iterator[Fact]:
    for name, channel in channels.items():
        before, after = plain(channel.rmse_before, 3), plain(channel.rmse_after, 3)
        value = f"{after if extended else before} {channel.unit}"
        sizes = (channel.rmse_before, channel.rmse_after)[: 1 + extended]
        note, noise = "", channel.noise_floor
        if noise and None not in sizes:
            over = " → ".join(plain(rms / noise, 2) for rms in sizes if rms is not None)
            note = f"{over} × noise level"
        yield Fact(in_words(name), value, note, before if extended else "")


def _gains(named: Sequence[NamedCause]) -> Iterator[Fact]:
    for cause in named:
        low, high = cause.gain_interval_percent or (None, None)
        gain, interval = with_interval(cause.gain_percent, low, high)
        by = f" by {within(cause.title or title_of(cause.effect))}" if len(named) > 1 else ""
        if interval == ABSENT:
            yield Fact(f"{_REDUCTION}{by}", f"{plain(cause.gain_percent, 3)} % lower")
        else:
            yield Fact(f"{_REDUCTION}{by}", f"{gain} % lower", f"95 %: {interval} %")


def _of_tracking(tracking: TrackingFile) -> Glance:
    by_controller: dict[str, list[TrackedResult]] = {}
    for result in tracking.results:
        by_controller.setdefault(result.controller, []).append(result)
    means = {name: results[0].scores.rmse_N.mean for name, results in by_controller.items()}
    known = {name: mean for name, mean in means.items() if mean is not None}
    verdict = f"Followed by {listed(list(by_controller))}"
    if len(known) > 1:
        verdict = f"{min(known, key=lambda name: known[name]).capitalize()} follows best"
    facts = []
    for name, (first, *others) in by_controller.items():
        sizes = [f"{plain(it.scores.rmse_N.mean, 3)} N" for it in (first, *others)]
        more = zip(others, sizes[1:], strict=True)
        facts.append(Fact(name, sizes[0], "; ".join(f"{it.condition}: {n}" for it, n in more)))
    numbers = f"Root mean square error of the force, {tracking.results[0].condition}"
    return Glance("Tracking, simulated", verdict, numbers, tuple(facts))


def _of_closing(closing: ClosingFile) -> Glance:
    total, named = len(closing.cases), sum(bool(case.named) for case in closing.cases)
    facts = []
    for name, rows in closing.of_controllers().items():
        sheet, _, extended, true = (
            plain(median(values), 2)
            for values in zip(
                *([rmse.mean for rmse in row.by_model.values()] for row in rows.values()),
                strict=True,
            )
        )
        facts.append(Fact(name, f"{extended} N", f"with the true model: {true} N", sheet))
    numbers = "RMSE of the force with the data sheet's model → with the extended one"
    verdict = f"A cause is {'' if named else 'not '}named"
    if total > 1:
        numbers += f", median of {total} cases"
        verdict = f"A cause is named in {named} of {total} cases"
    return Glance("Hidden differences, diagnosed and tracked", verdict, numbers, tuple(facts))


def _of_simulation(simulation: SimulationFile) -> Glance | None:
    ratios: dict[str, list[float]] = {}
    for run in simulation.runs.values():
        for name, channel in run.channels.items():
            if channel.rmse is not None and channel.noise:
                ratios.setdefault(name, []).append(channel.rmse / channel.noise)
    if not ratios:
        return None
    worst = max(map(max, ratios.values()))
    facts = (Fact(in_words(name), span_text(found)) for name, found in ratios.items())
    return Glance(
        "Simulation against measurement",
        f"Within {plain(worst, 2)} times the noise",
        "Root mean square error in times the noise, over the runs",
        tuple(facts),
    )
