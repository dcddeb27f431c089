"""Structures of a drive in words, and what its recordings do not tell."""

from tests.drive.verdicts import cause, terms, verdict
from tsas_cli.drive.estimates import DataSheet
from tsas_cli.drive.harmonic_drive import DriveValues
from tsas_cli.drive.search import NOTHING
from tsas_cli.drive.sentences import (
    EQUATION_NAME,
    STIFF_NAME,
    cannot_tell,
    equation_of,
    inverse_of,
    name_of,
    next_run,
)
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.base import Fit
from tsas_cli.records.drive import DriveDiagnosis, DriveFile, FrequencyResponses, Pole


def test_structures_in_words():
    assert name_of(NOTHING) == "integrator"
    assert name_of(terms("leak")) == "1/(s + a)"
    assert name_of(terms("delay", "spring")) == "integrator with second-order lag and delay"
    assert equation_of(NOTHING) == "G(s) = K / s"
    assert equation_of(terms("lag", "delay")) == "G(s) = K e^(−Ts) / (s (τs + 1))"
    whole = equation_of(terms("leak", "lag", "spring"))
    assert whole == "G(s) = K / ((s + a) (τs + 1) (s²/ω² + 2ζs/ω + 1))"


def test_the_inverse_in_words():
    assert inverse_of(DriveValues(0.02)).startswith("G⁻¹(s) ≈ 50 s; u_ff")
    slow = DriveValues(0.02, motor_lag_s=0.1, leak_per_s=0.3)
    assert inverse_of(slow).startswith("G⁻¹(s) ≈ 51.5 s + 5 s² + 15; u_ff")


def found(rivals=(), unexplained=False):
    return verdict("named", cause("backlash", rivals=rivals), unexplained=unexplained)


def test_what_to_record_next():
    assert "higher frequencies" in next_run(found(("play",), True))
    assert "Repeat a run" in next_run(found((), True))
    assert "half the amplitude" in next_run(found())


def drive(band=(0.5, 12.0), poles=(), converged=True, **diagnosis):
    """Return the part of a record that says what is not identifiable."""
    return DriveFile.model_construct(
        diagnosis=DriveDiagnosis(verdict="sufficient", reason="", **diagnosis),
        frequency_response=FrequencyResponses.model_construct(band_Hz=band),
        poles=tuple(poles),
        fit=Fit(converged=converged, message="too many steps"),
    )


NO_SHEET = DataSheet(None, None, None, None)
SHEET = DataSheet(27.1, 120.0, 0.13, 2.3)


def test_what_is_not_identifiable_of_a_drive():
    lag = {"kind": "lag", "real_per_s": -1.0, "imaginary_per_s": 0.0}
    far = Pole(**lag, frequency_Hz=23.0, in_band=False)
    near = Pole(**lag, frequency_Hz=3.0, in_band=True)
    quiet = cannot_tell(drive(poles=[near]), SHEET, terms("spring"), ())
    assert quiet == []
    (outside,) = cannot_tell(drive(poles=[near, far]), SHEET, terms("spring"), ())
    assert outside.startswith(
        "A lag lies at 23 Hz, outside of the band that the input shows (0.5 to"
    )
    assert cannot_tell(drive(nominal=EQUATION_NAME), SHEET, NOTHING, ()) == [
        "These recordings show no resonance: the drive is stiffer than they tell, beyond 12 Hz."
    ]
    (stiffer,) = cannot_tell(drive(nominal=STIFF_NAME), SHEET, NOTHING, ())
    assert stiffer == (
        "Eq. (25) with J, r1 and k_p of the data sheet has a resonance at 18.1 Hz, which these "
        "recordings do not show, nor another one: the drive is stiffer than they tell, beyond "
        "12 Hz, and is compared with a stiff one."
    )
    lag = cause("channel_delay", "first-order lag", ("drive_compliance",))
    assert cannot_tell(drive(nominal=STIFF_NAME, named=[lag]), SHEET, terms("lag"), ()) == [
        "These recordings do not separate a resonance, beyond 12 Hz, from a first-order lag."
    ]
    dark = cannot_tell(drive(None, [far], nominal=EQUATION_NAME), SHEET, NOTHING, ())
    assert "coherence above 0.8" in dark[0]
    assert dark[1].endswith("stiffer than they tell.")
    assert len(dark) == 2
    ratios, reaction = cannot_tell(drive(), NO_SHEET, terms("spring"), ())
    assert ratios.startswith("Speed and position show ratios")
    assert "pull-back k_p" in reaction
    bound = {
        "play_mm": Estimate("play_mm", 0.0, "mm", "fitted", at_bound=True),
        "delay_s": Estimate("delay_s", 0.1, "s", "fitted"),
    }
    assert cannot_tell(drive(), SHEET, terms("spring"), bound.values()) == [
        "play_mm ended at its bound."
    ]
    (said,) = cannot_tell(drive(converged=False), SHEET, terms("spring"), ())
    assert said == "The fit did not converge: too many steps."
