"""A sheath that is bent more here than there, against the independent rig."""

from functools import cache

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.physics.response import DriveInput, simulate
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.tendon import Rig as VirtualRig
from tsas_studies.challenge.rig.tendon import simulate as run_rig

MOTION = sine(omega_rad_s=1.0, rate_Hz=200.0)
SHARE = 0.3


@cache
def tensions(profile=((0.0, 1.0),), **uneven):
    """Return the tension at the drive of the rig, and of the model."""
    virtual = VirtualRig(cells=60, bend_profile=profile)
    columns = run_rig(virtual, MOTION).columns
    model = GROUP_A._replace(tendon_stiffness_N=virtual.axial_stiffness, **uneven)
    response = simulate(model, DriveInput(columns["x_in_mm"]), nodes=60)
    return np.array([columns["f_in_N"], response.f_in_N])


@pytest.mark.parametrize("way", ["bend_slope", "bend_bow"])
def test_an_uneven_bend_does_what_it_does_to_the_rig(way):
    """Where length per angle is larger by a share, the curvature is smaller by it."""
    angle = np.linspace(-1.0, 1.0, 401)
    shape = angle if way == "bend_slope" else 1.5 * angle**2 - 0.5
    length = np.cumsum(1.0 + SHARE * shape)
    place = (length - length[0]) / (length[-1] - length[0])
    profile = tuple(zip(place.tolist(), (1.0 / (1.0 + SHARE * shape)).tolist(), strict=True))
    expected, change = tensions(profile, **{way: SHARE}) - tensions()
    assert np.abs(expected).max() > 0.5
    assert np.sqrt(np.mean((change - expected) ** 2)) < 0.03 * np.sqrt(np.mean(expected**2))
