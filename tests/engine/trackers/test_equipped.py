"""What a flown drone carries."""

import math

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.trackers.airframe import ORIGINAL
from eyas.engine.trackers.airframes import AIRFRAMES
from eyas.engine.trackers.battery import open_voltage
from eyas.engine.trackers.config import TrackerConfig
from eyas.engine.trackers.equipment import MOUNTED, Part, loaded
from eyas.engine.trackers.ground_effect import ground_effect
from eyas.lanes import interpreted

from ...kit.flight import FLOWN, Drones, held

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


def with_options(**options):
    return TrackerConfig(supervised=False, **options)


def test_a_payload_pulls_it_down_and_to_its_side():
    log = Drones(config=with_options(payload={"mass": 0.5, "position": (0.0, 0.02, -0.1)})).fly(
        held(steps=8000)
    )
    sunk = ((3.0069 + 0.5) * 9.81 - 3.0 * 9.8) / 17.0
    assert log.position[-1, 0, 2] == pytest.approx(20.0 - sunk, abs=1e-3)
    # It leans to the side of the payload until its controller turns it back.
    aside = 3.5069 * 9.81 * math.tan(0.5 * 0.02 * 9.81 / 4.0) / 8.0
    assert log.position[-1, 0, :2] == pytest.approx([0.0, aside], abs=2e-3)


def test_near_the_ground_it_needs_less_thrust_and_far_from_it_no_less():
    share = interpreted(ground_effect)
    frame = ORIGINAL._replace(arm=1e6)  # one rotor alone: Cheeseman and Bennett
    for z in (0.2, 0.5, 1.0):
        assert share(frame, 0.165, z) == pytest.approx(1.0 / (1.0 - (0.165 / (4.0 * z)) ** 2))
    assert share(ORIGINAL, 0.165, 0.2) > 1.05
    assert share(ORIGINAL, 0.165, 5.0) == pytest.approx(1.0, abs=1e-3)
    low = Drones(config=with_options(ground_effect=True), height=0.5).fly(held(steps=5000))
    risen = (ground := share(ORIGINAL, 0.165, low.position[-1, 0, 2] + 0.02305)) - 1.0
    assert ground > 1.01
    sunk = (3.0069 * 9.81 / (1.0 + risen) - 3.0 * 9.8) / 17.0
    assert 0.5 - low.position[-1, 0, 2] == pytest.approx(sunk, abs=1e-4)


def test_a_battery_gives_what_the_rotors_take():
    drones = Drones(config=with_options(battery={"enabled": True, "charge": 0.9}))
    assert drones.memory.charge[0] == 0.9
    volts = 6.0 * interpreted(open_voltage)(0.9)
    assert drones.memory.voltage[0] == pytest.approx(volts)
    drones.fly(held(steps=5000))
    thrust = 3.0069 * 9.81 / 4.0
    power = 4.0 * 0.02 * thrust * math.sqrt(thrust / 2.55e-5) / 0.8 + 10.0
    current = power / drones.memory.voltage[0]
    volts = 6.0 * interpreted(open_voltage)(drones.memory.charge[0])
    assert volts - drones.memory.voltage[0] == pytest.approx(0.030 * current, rel=0.02)
    assert 0.9 - drones.memory.charge[0] == pytest.approx(current * 10.0 / (4.5 * 3600), rel=0.01)


def test_an_empty_battery_lets_it_fall_and_a_low_one_makes_it_slow():
    falls = Drones(config=with_options(battery={"enabled": True, "charge": 1e-4}), height=500.0)
    log = falls.fly(held(steps=1500))
    assert falls.memory.charge[0] == 0.0
    assert log.velocity[-1, 0, 2] < -10.0
    climbs = [
        Drones(config=with_options(battery={"enabled": True, "charge": charge}))
        for charge in (1.0, 0.02)
    ]
    full, low = (drones.fly(held(up=0.1, steps=300)).velocity[-1, 0, 2] for drones in climbs)
    assert full > low + 0.5


@pytest.mark.parametrize(
    ("name", "to_weight", "top", "minutes"),
    [("5-inch", 4.6, 27.2, 7.5), ("10-inch", 1.69, 31.2, 15.0), ("20-inch", 2.75, 23.0, 56.0)],
)
def test_airframes_fly_as_their_sources_say(name, to_weight, top, minutes):
    frame = AIRFRAMES[name].frame
    most = frame.thrust_constant * frame.rotor_limit**2
    assert 4.0 * most / (frame.mass * frame.gravity) == pytest.approx(to_weight, abs=0.02)
    config = with_options(airframe=name, battery={"enabled": True})
    drones = Drones(2, config=config, height=100.0)
    commands = np.stack([held(steps=6000), held(forward=80.0, steps=6000)], axis=1)
    log = drones.fly(commands)
    assert log.velocity[-1, 1, 0] == pytest.approx(top, abs=0.2)
    assert 12.0 / 60.0 / (1.0 - drones.memory.charge[0]) == pytest.approx(minutes, abs=0.7)
    assert np.abs(log.velocity[-1, 0]).max() < 1e-3


def test_what_does_not_go_together_is_refused_in_one_line():
    for options, said in (
        ({"airframe": "5-inch", "off_centre": True}, "off_centre"),
        ({"airframe": "6-inch"}, "airframe"),
        ({"payload": {"mass": 1.0}, "supervised": True}, "payload.mass"),
    ):
        with pytest.raises(ConfigError, match=said) as caught:
            TrackerConfig(**{"supervised": False} | options)
        assert "\n" not in str(caught.value)
