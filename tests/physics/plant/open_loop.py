"""The plant without a controller: the motor goes along a given way, quickly made and run."""

import numpy as np

from tsas_cli.controllers.closed_loop import (
    F_IN,
    F_OUT,
    MOTOR,
    X_IN,
    X_OUT,
    DriveSensor,
    LoopPlant,
    LoopReference,
    close_loop,
    plant_at_rest,
)
from tsas_cli.controllers.pid import Pid
from tsas_cli.controllers.signals import error_filter
from tsas_cli.physics.plant.laws import plant_laws
from tsas_cli.physics.plant.lugre_plant import empty_lumps
from tsas_cli.tracking.settings import Settings

ACTUATOR = Settings().drive.actuator()
CHANNELS = {"x_in_mm": X_IN, "x_out_mm": X_OUT, "f_in_N": F_IN, "f_out_N": F_OUT}


def run(rig, motor_mm, step_s, *, lumped, n=50, substeps=4, actuator=ACTUATOR, later=None, at=-1):
    """Return the channels, the motor's speed [mm/s], and how many steps did not settle."""
    m = motor_mm.size
    rpm = np.append(np.diff(motor_mm) / step_s, 0.0) / actuator.gain_mm_per_s_rpm
    laws = (
        Settings()
        .controllers.laws("pid", actuator.gain_mm_per_s_rpm)
        ._replace(pid=Pid(0.0, 0.0, 0.0))
    )
    path = np.zeros((4, m))
    path[0] = motor_mm
    columns, unsettled, done = close_loop(
        LoopReference(path, rpm),
        DriveSensor(step_s, np.zeros(m), 0.0, *error_filter(10.0, step_s)),
        laws,
        LoopPlant(
            actuator=actuator,
            rigs=(rig, later or rig),
            laws=(plant_laws(rig), plant_laws(later or rig)),
            change_at=at,
            substeps=substeps,
            nodes=n,
            start=plant_at_rest(float(motor_mm[0]), rig, actuator, n),
        ),
        empty_lumps() if lumped else None,
    )
    assert done == m
    channels = {name: columns[row] for name, row in CHANNELS.items()}
    return channels, columns[MOTOR] * actuator.gain_mm_per_s_rpm, unsettled
