"""Absurd numbers at the doors of a simulation and of the renderer."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.bounds import FARTHEST, LARGEST, checked, limited
from eyas.engine.core.config import updated
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.snapshot import CameraState

ABSURD = (1e300, -1.7e308, 1e30, 2.0**62, -1e9, np.inf, -np.inf, np.nan)
NOT_FINITE = (np.inf, -np.inf, np.nan)
ONE = np.zeros(1, np.int32)


FLOWN = {"supervised": False, "drag_area": 0.1, "wind": {"speed": 5.0, "buildings": True}}
KINDS = {
    "supervised": {},
    "flown": {"tracker": {"supervised": False}},
    "car": {"tracker": {"kind": "car"}},
    "contact": {
        **{"world": {"map": "lake"}, "tracker": FLOWN},
        **{"lidar": {"enabled": True}, "done": {"crash": "contact"}},
    },
}


@pytest.fixture(scope="module", params=KINDS)
def simulation(request):
    small = {"world": {"map": "desert-bare"}, "camera": {"width": 64, "height": 48}}
    config = updated(updated(EyasConfig(), small), KINDS[request.param])
    return build_simulation(config, together(1))


@pytest.fixture
def picture():
    return Picture.create(1, 48, 64, subject=True)


def is_sound(simulation, picture):
    simulation.view.draw(ONE, picture)
    arrays = [array for record in simulation.snapshot[:3] for array in record]
    finite = all(np.isfinite(array).all() for array in arrays)
    return finite and np.abs(simulation.snapshot.trackers.position).max() <= 1.1 * FARTHEST


@pytest.mark.slow
@pytest.mark.parametrize("width", [4, 8])
def test_absurd_commands_leave_a_state_that_can_be_drawn_and_flown_on(simulation, picture, width):
    simulation.reset()
    for number, steps in itertools.product(ABSURD, (1, 200)):
        for column in (*range(width), slice(None)):
            command = np.zeros((1, width))
            command[:, column] = number
            simulation.advance(command, steps)
        assert is_sound(simulation, picture)


@pytest.mark.slow
def test_places_and_angles_are_limited_or_refused(simulation, picture):
    cameras = CameraState.create(1)
    doors = [
        lambda x: simulation.place(np.full((1, 4), x)),
        lambda x: simulation.start_at(np.arange(1), np.full((1, 4), x), np.zeros(1)),
        lambda x: simulation.start_at(np.arange(1), np.zeros((1, 4)), np.full(1, x)),
        lambda x: simulation.command_gimbal(np.full((1, 2), x)),
        lambda x: simulation.set_fields_of_view(np.full(1, x)),
        lambda x: (simulation.turn_starts(np.full(1, x)), simulation.reset()),
        lambda x: draw(position=np.full((1, 3), x)),
        lambda x: draw(rotation=np.full((1, 3, 3), x)),
        lambda x: draw(field_of_view=np.full(1, x)),
    ]

    def draw(**changes):
        simulation.draw_from(ONE, cameras._replace(**changes), picture)

    for door, number in itertools.product(doors, (*ABSURD, 0.0, -1.0)):
        simulation.reset()
        if number in NOT_FINITE or number != number:
            with pytest.raises(EyasError, match="allowed: finite numbers"):
                door(number)
        else:
            door(number)
            for _ in range(16):
                simulation.advance(np.zeros((1, 4)), 20)
        assert is_sound(simulation, picture)


def test_usual_numbers_are_not_touched():
    usual = np.array([[40.0, -1e4 / 2, 0.01, 2.0]])
    assert limited(usual, LARGEST) is usual
    assert checked(usual, FARTHEST, "x") is usual
    many = np.full((4096, 4), 100.0)
    assert (limited(many, LARGEST) == many).all()
    assert limited(np.array([np.nan, np.inf, -1e300]), 5.0).tolist() == [0.0, 5.0, -5.0]


@pytest.mark.thorough  # all kernels are compiled for it
def test_no_kernel_leaves_its_arrays(tmp_path):
    """The tests above with kernels that report each index outside of its array."""
    checked_kernels = {
        **{"NUMBA_BOUNDSCHECK": "1", "EYAS_SHIPPED_CODE": "0", "EYAS_CACHE_DIR": str(tmp_path)},
        "PYTHONPATH": str(Path(__file__).with_name("checked_indices")),
    }
    command = [sys.executable, "-m", "pytest", "-s", "-x", __file__, "-p", "no:cacheprovider"]
    told = subprocess.run(
        command, env=os.environ | checked_kernels, capture_output=True, text=True, check=False
    )
    assert "OUTSIDE" not in told.stdout
    assert told.returncode == 0, told.stdout + told.stderr
