"""What Table 5 of Yang 2025 prints for a run, where the run is made as the paper's is."""

from tsas_cli.paper import yang2025
from tsas_cli.tracking.conditions import Condition, proximal_spring
from tsas_cli.tracking.settings import Settings, printed_gains


def printed_rmse(
    controller: str, condition: Condition, reference: str, settings: Settings
) -> float | None:
    """Return the printed RMSE of a controller, None where anything is not the paper's.

    The gains may be read per m or per mm.
    """
    as_the_paper = reference == "sine" and settings in (Settings(), printed_gains(Settings()))
    undisturbed = not condition.changes
    if not as_the_paper or not (undisturbed or condition == proximal_spring()):
        return None
    name = "undisturbed" if undisturbed else "disturbed"
    printed = yang2025().values.get(f"tracking.{name}.rmse_{controller.replace('-', '_')}")
    return None if printed is None else printed.value
