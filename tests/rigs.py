"""Recordings of the independent rig in its sine, and datasets of them."""

from functools import cache
from types import MappingProxyType

from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import Run, conditions, record, write_dataset
from tsas_studies.challenge.rig.sensors import Sensors


@cache
def recorded(rig, rate_Hz=100.0, seed=0):
    """Return the columns of two periods by sensors of this rate, simulated at twice as many."""
    columns = record(rig, sine(rate_Hz=2.0 * rate_Hz), sensors=Sensors(rate_Hz=rate_Hz), seed=seed)
    for values in columns.values():
        values.flags.writeable = False
    return MappingProxyType(columns)  # which every test shares


def dataset_of(rig, folder, *, told=(), **runs):
    """Write a dataset of runs on a rig, by id their columns; `told` changes the conditions."""
    told = conditions(rig) | dict(told)
    return write_dataset(folder, [Run(name, columns, told) for name, columns in runs.items()])
