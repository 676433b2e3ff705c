"""Absurd numbers at the doors of a simulation and of the renderer."""

import itertools

import numpy as np
import pytest

from eyas.core.bounds import FARTHEST, LARGEST, checked, limited
from eyas.core.config import updated
from eyas.core.errors import EyasError
from eyas.settings.config import EyasConfig
from eyas.sim.build import build_simulation
from eyas.sim.worlds import together
from eyas.state.draw import Picture
from eyas.state.snapshot import CameraState

ABSURD = (1e300, -1.7e308, 1e30, 2.0**62, -1e9, np.inf, -np.inf, np.nan)
NOT_FINITE = (np.inf, -np.inf, np.nan)
ONE = np.zeros(1, np.int32)


@pytest.fixture(scope="module", params=["supervised", "flown", "car"])
def simulation(request):
    tracker = {"supervised": request.param != "flown", "kind": "drone"}
    tracker["kind"] = "car" if request.param == "car" else "drone"
    small = {"width": 64, "height": 48}
    changes = {"world": {"map": "desert-bare"}, "camera": small, "tracker": tracker}
    return build_simulation(updated(EyasConfig(), changes), together(1))


@pytest.fixture
def picture():
    return Picture.create(1, 48, 64, subject=True)


def is_sound(simulation, picture):
    simulation.view.draw(ONE, picture)
    arrays = [array for record in simulation.snapshot[:3] for array in record]
    finite = all(np.isfinite(array).all() for array in arrays)
    return finite and np.abs(simulation.snapshot.trackers.position).max() <= FARTHEST


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
            simulation.advance(np.zeros((1, 4)), 20)
        assert is_sound(simulation, picture)


def test_usual_numbers_are_not_touched():
    usual = np.array([[40.0, -1e4 / 2, 0.01, 2.0]])
    assert limited(usual, LARGEST) is usual
    assert checked(usual, FARTHEST, "x") is usual
    many = np.full((4096, 4), 100.0)
    assert (limited(many, LARGEST) == many).all()
    assert limited(np.array([np.nan, np.inf, -1e300]), 5.0).tolist() == [0.0, 5.0, -5.0]
