"""What a flown drone carries."""

import numpy as np
import pytest

from eyas.trackers.airframe import ORIGINAL
from eyas.trackers.config import TrackerConfig
from eyas.trackers.equipment import MOUNTED, Part, loaded

from .flight import FLOWN, Drones, held

OFF = TrackerConfig(supervised=False, off_centre=True)


def test_parts_have_the_centre_and_the_moments_of_their_points():
    rng = np.random.default_rng(4)
    parts = [Part(0.1 + rng.random(), tuple(rng.normal(size=3))) for _ in range(4)]
    made = loaded(ORIGINAL, parts)
    assert made.frame.mass == pytest.approx(ORIGINAL.mass + sum(part.mass for part in parts))
    masses = np.array([ORIGINAL.mass, *(part.mass for part in parts)])
    places = np.array([(0.0, 0.0, 0.0), *(part.place for part in parts)])
    centre = masses @ places / masses.sum()
    expected = np.diag(ORIGINAL.inertia)
    for mass, arm in zip(masses, places - centre, strict=True):
        expected += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    xx, yy, zz, xy, xz, yz = made.inertia
    told = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert made.centre == pytest.approx(centre)
    assert told == pytest.approx(expected)
    xx, yy, zz, xy, xz, yz = made.inverse
    assert np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ told == pytest.approx(np.eye(3))


def test_gimbal_and_lidar_hold_it_ahead_of_its_command_as_its_controller_answers_them():
    log = Drones(config=OFF).fly(held(steps=10_000))
    moment = 9.81 * sum(part.mass * part.place[0] for part in MOUNTED)
    # 4 N m/rad turn it back by an angle at which its weight pulls ahead, which 8 N/m hold.
    ahead = 3.0 * 9.8 * np.tan(moment / 4.0) / 8.0
    assert log.position[-1, 0, 0] == pytest.approx(ahead, rel=5e-3)
    assert ahead == pytest.approx(0.120, abs=5e-4)
    assert log.euler[-1, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-4)


def test_what_is_carried_in_the_middle_changes_only_its_weight():
    plain = Drones(config=FLOWN).fly(held(forward=4.0, left=1.0, steps=500))
    drones = Drones(config=OFF)
    centred = loaded(ORIGINAL._replace(mass=2.0), [Part(ORIGINAL.mass - 2.0, (0.0, 0.0, 0.0))])
    drones.memory = drones.memory._replace(equipment=centred)
    log = drones.fly(held(forward=4.0, left=1.0, steps=500))
    assert log.position == pytest.approx(plain.position, abs=1e-11)
