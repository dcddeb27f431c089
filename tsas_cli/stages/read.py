"""Open what is on disk: a dataset, a model, an identified drive."""

from collections.abc import Iterable

from tsas_cli.drive.file import IdentifiedDrive
from tsas_cli.drive.file import read_drive as read_drive_file
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_model as read_model_file
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.stages.given import Named, dataset_of, file_of


def read(folder: Named, runs: Iterable[str] | None = None) -> Dataset:
    """Open a dataset; its recordings are read when they are asked for.

    Parameters
    ----------
    folder
        A dataset's folder, with `dataset.toml` and `runs/ID.parquet`.
    runs
        The ids of the runs that count; all without it.

    Returns
    -------
    Dataset
        `dataset["a"]` is run a: `.columns` holds float64 arrays of shape (n,) by name, with the
        unit in it (`time_s`, `x_in_mm`, `f_in_N`, …), NaN where nothing was recorded; `.frame()`
        is the same as a pandas table over `time_s`; `.run` holds the conditions.
        `dataset.manifest.rig` is the data sheet. A loop over the dataset gives one run after the
        other.

    Raises
    ------
    InputError
        The folder holds no dataset of format 1, or there is no such run.

    Examples
    --------
    >>> import tsas_cli as tsas
    >>> data = tsas.read("datasets/paper-groups")
    >>> float(data["a"].columns["x_in_mm"].max().round())
    20.0
    """
    return dataset_of(folder, runs)


def read_model(path: Named) -> Model:
    """Read a model from `model.toml` or `model-extended.toml`.

    Parameters
    ----------
    path
        The file, or the folder that `calibrate` has written.

    Returns
    -------
    Model
        `.estimates` holds every value with unit, interval (95 %), standard error and bound flag;
        `.estimate("preload_N", run="a")` is one of them, `.value(...)` its number.

    Raises
    ------
    InputError
        The file is missing, is no model, or names what this version does not know.
    """
    return read_model_file(file_of(path))


def read_drive(path: Named) -> IdentifiedDrive:
    """Read an identified drive from `drive.toml`.

    Parameters
    ----------
    path
        The file, or the folder that `identify_harmonic_drive` has written.

    Returns
    -------
    IdentifiedDrive
        The drive's values, with the unit in each name.

    Raises
    ------
    InputError
        The file is missing or is no drive.
    """
    return read_drive_file(file_of(path))
