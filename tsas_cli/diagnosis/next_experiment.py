"""The next experiment, for a stronger verdict."""

from collections.abc import Sequence

from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.plan import propose
from tsas_cli.diagnosis.proof import BY_NAME
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.wording import listed

# By the signal that a remaining residual depends on most: the recording that says most of it.
OF_REMAINDER = {
    "f_in_N": "Repeat one run at another preload: what depends on the tension moves along the "
    "stroke with it.",
    "x_in_mm": "Repeat one run with the stroke moved along by a quarter: what belongs to a place "
    "moves against the stroke.",
    "speed_mm_per_s": "Repeat one run at half the speed: what depends on the speed changes, what "
    "depends on the place does not.",
    "travel_since_reversal_mm": "Record nested strokes, each shorter than the last: the tension "
    "over the travel since the reversal must be the same curve in all.",
}
REPEAT = (
    "Repeat one run without any change: a residual that recurs is systematic, one that does not "
    "is random."
)


def next_experiment(result: Diagnosis, step: Steps = NO_PROGRESS) -> str:
    """Return the instruction for the next experiment."""
    if result.verdict == "undecided" and result.fault is not None:
        if result.fault.run is None:
            return "Correct recordings or manifest, or remove what disturbs and record again."
        return (
            "Correct the recording, or leave its run out, and diagnose again; then record that run "
            "once more without any change."
        )
    if result.verdict == "undecided" and result.search is not None:
        return "Repeat the call and let the search end; fewer runs (--runs) take less time."
    if not result.converged:
        return (
            "Check units, signs and which end is which; state in dataset.toml what is known: "
            "load_stiffness_N_per_mm, preload_N, a second tendon by antagonist_preload_N."
        )
    if result.verdict == "undecided":
        return (
            "Record longer runs, at least three: in each the drive has to travel through several "
            "whole strokes, with f_in_N and one of f_out_N and x_out_mm."
        )
    unsure = next((cause for cause in result.causes if cause.rivals), None)
    if unsure is not None and result.judged is not None and result.final is not None:
        among = [unsure.effect, *unsure.rivals]
        this, *others = [BY_NAME[name].title.lower() for name in among]
        how = _experiment(result.judged.bench, result.final, among, step)
        return f"To distinguish {this} from {listed(others, ' or ')}: {how[0].lower()}{how[1:]}"
    if result.unexplained:
        signals = () if result.remainder is None else result.remainder.depends_on
        asked = [s for s in signals if s in OF_REMAINDER and (s != "f_in_N" or _preloaded(result))]
        return OF_REMAINDER[asked[0]] if asked else REPEAT
    if result.causes:
        first = max(result.causes, key=lambda cause: cause.gain_percent)
        return BY_NAME[first.effect].experiment
    return "No effect is missing here; runs at other loads, speeds and bends would test more."


def _preloaded(result: Diagnosis) -> bool:
    """Return whether a run states a preload, so that there may be another."""
    bench = None if result.judged is None else result.judged.bench
    return bench is None or any(run.run.run.preload_N is not None for run in bench.closed)


def _experiment(bench: Bench, final: HypothesisFit, among: Sequence[str], step: Steps) -> str:
    """Return what tells effects apart: further channels where one alone is compared, or a run."""
    if len(bench.channels) == 1:
        recorded = bench.closed[0].run
        known = (*recorded.measured, *recorded.conditioned)
        missing = [name for name in CHANNELS if name not in known]
        return f"Record the same motion with {listed(missing)} too."
    run = propose(bench, final, among, step)
    return BY_NAME[among[0]].experiment if run is None else f"Record {run.sentence}."
