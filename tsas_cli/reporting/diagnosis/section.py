"""What the diagnosis says: the verdict, its causes, the evidence, and what to measure next."""

from tsas_cli.records.diagnosis import Diagnosis
from tsas_cli.reporting.content import Section, missing
from tsas_cli.reporting.diagnosis import candidates, causes, gains, likeness, maps, remainder
from tsas_cli.reporting.inputs import Inputs

_TITLE = "Diagnosis"


def section(inputs: Inputs) -> Section:
    """Return the section of the diagnosis; its first sentence is the verdict."""
    diagnosis = inputs.get(Diagnosis)
    if diagnosis is None:
        return missing("diagnosis", _TITLE, what="diagnosis", stage="diagnose")
    evidence = (part.part(diagnosis) for part in (gains, maps, candidates, likeness))
    return Section(
        "diagnosis",
        _TITLE,
        (_verdict(diagnosis),),
        parts=(
            *causes.parts(diagnosis),
            *(part for part in evidence if part is not None),
            *remainder.parts(diagnosis),
        ),
    )


def _verdict(diagnosis: Diagnosis) -> str:
    undecided = diagnosis.verdict == "undecided"
    return f"Undecided: {diagnosis.reason}" if undecided else diagnosis.reason
