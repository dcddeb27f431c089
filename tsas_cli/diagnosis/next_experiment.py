"""The next experiment, for a stronger verdict."""

from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.plan import propose
from tsas_cli.effects import EFFECTS
from tsas_cli.support.steps import NO_PROGRESS, Steps


def next_experiment(result: Diagnosis, step: Steps = NO_PROGRESS) -> str:
    """Return the instruction for the next experiment."""
    experiments = {effect.name: effect.experiment for effect in EFFECTS}
    if result.verdict == "undecided" and result.fault is not None:
        if result.fault.run is None:
            return "Correct the recordings, or remove what disturbs them and record again."
        return (
            "Correct the recording, or leave its run out, and diagnose again; then record that run "
            "once more without any change."
        )
    if result.verdict == "undecided" and result.search is not None:
        return "Repeat the call and let the search end; fewer runs (--runs) take less time."
    if result.verdict == "undecided":
        return (
            "Record longer runs, at least three: in each the drive has to travel through several "
            "whole strokes, with f_in_N and one of f_out_N and x_out_mm."
        )
    unsure = [cause for cause in result.causes if cause.rivals]
    if unsure and result.judged is not None and result.final is not None:
        among = [unsure[0].effect, *unsure[0].rivals]
        further = propose(result.judged.bench, result.final, among, step)
        return f"{further} {experiments[unsure[0].effect]}"
    if result.causes:
        first = max(result.causes, key=lambda cause: cause.gain_percent)
        return experiments[first.effect]
    if result.unexplained:
        return (
            "Repeat one run without any change: a residual that recurs is systematic, one that "
            "does not is random; then vary speed, load and bend one at a time."
        )
    return "No effect is missing here; runs at other loads, speeds and bends would test more."
