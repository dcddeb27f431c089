"""What the paper prints stands beside a run only where the run is made as the paper's is."""

from tsas_cli.controllers.pid import PidSettings
from tsas_cli.tracking.conditions import Condition, disturbed, printed_rmse, proximal_spring
from tsas_cli.tracking.settings import ReferenceSettings, Settings, printed_gains

QUIET = Condition("undisturbed")


def test_each_controller_and_condition_has_its_number():
    for settings in (Settings(), printed_gains(Settings())):
        assert printed_rmse("pid", QUIET, "sine", settings) == 1.4654
        assert printed_rmse("sliding-mode", QUIET, "sine", settings) == 0.8271
        assert printed_rmse("adaptive-sliding-mode", proximal_spring(), "sine", settings) == 0.5735


def test_nothing_stands_beside_what_the_paper_has_not_done():
    fast = Settings(reference=ReferenceSettings(angular_frequency_rad_per_s=2.0))
    gains = Settings().controllers.model_copy(
        update={"pid": PidSettings(proportional_rpm_per_mm=30.0)}
    )
    others = (
        ("disturbance-observer", QUIET, "sine", Settings()),
        ("pid", QUIET, "ramps", Settings()),
        ("pid", QUIET, "sine", fast),
        ("pid", QUIET, "sine", Settings().model_copy(update={"controllers": gains})),
        ("pid", disturbed(["proximal_spring.stiffness_N_per_mm=13"]), "sine", Settings()),
    )
    assert [printed_rmse(*other) for other in others] == [None] * 5
