"""Events of flights: their number against what the pictures between would tell, and repeats."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.esim import EVENT
from eyas.engine.camera.events import EventsConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import StartConfig

SIZE = 48
ONE = np.zeros(1, np.int32)
TURN = np.array([[0.0, 0.0, 0.0, 1.0]])


def simulation_of(count=1, **events):
    camera = CameraConfig(width=SIZE, height=SIZE, events=EventsConfig(enabled=True, **events))
    # Nobody walks or waits: what is told comes from the camera's own motion.
    config = SimConfig(
        camera=camera,
        start=StartConfig(height=10.0, pitch=0.8),
        traffic={"signals": "amber"},
        extras=[],
    )
    simulation = build_simulation(config, each_alone(count))
    simulation.reset()
    return simulation


def told_by(simulation, chosen=ONE):
    sensors = simulation.view.events(chosen)
    return [sensors.events_of(n) for n in chosen.tolist()]


def test_the_first_look_tells_nothing_and_the_same_instant_the_same():
    simulation = simulation_of()
    assert len(told_by(simulation)[0]) == 0
    simulation.advance(TURN, 20)
    first = told_by(simulation)[0]
    assert len(first) > 500
    assert first.dtype == EVENT
    np.testing.assert_array_equal(told_by(simulation)[0], first)
    assert (np.diff(first["t"]) >= 0).all()
    assert first["t"].min() >= 0
    assert first["t"].max() <= 40_000
    simulation.advance(TURN, 20)
    second = told_by(simulation)[0]
    assert second["t"].min() >= 40_000
    assert second["t"].max() <= 80_000


def test_references_follow_the_light_to_less_than_a_threshold():
    """What was told, added up, is the change of the pictures' logarithm, to a threshold."""
    simulation = simulation_of(positive=0.1, negative=0.1)
    drawn = []
    total = np.zeros((SIZE, SIZE))
    for _ in range(6):
        for event in told_by(simulation):
            np.add.at(total, (event["y"], event["x"]), np.where(event["p"] == 1, 0.1, -0.1))
        picture = Picture.create(1, SIZE, SIZE, rgb=False, radiance=True)
        simulation.draw(ONE, picture)
        red, green, blue = picture.radiance[0].astype(float)
        drawn.append(np.log(0.2126 * red + 0.7152 * green + 0.0722 * blue + 0.001))
        simulation.advance(TURN, 10)
    change = drawn[-1] - drawn[0]
    assert np.abs(change).max() > 1.0
    assert np.abs(total - change).max() < 0.1 + 1e-4


def test_more_looks_tell_nearly_the_same_as_adaptive_sampling():
    """Looking at every physics step is the densest that there is."""
    rare, often = simulation_of(), simulation_of()
    told_by(rare), told_by(often)
    rare.advance(TURN, 20)
    few = told_by(rare)[0]
    many = []
    for _ in range(20):
        often.advance(TURN, 1)
        many.append(told_by(often)[0])
    many = np.concatenate(many)
    assert len(few) == pytest.approx(len(many), rel=0.3)  # grain of the ground flickers
    where = [np.histogram2d(e["y"], e["x"], bins=12, range=[[0, SIZE]] * 2)[0] for e in (few, many)]
    assert np.corrcoef(where[0].ravel(), where[1].ravel())[0, 1] > 0.95


def test_events_do_not_depend_on_other_trackers_or_threads():
    settings = {"mismatch": 0.03, "leak": 0.1, "shot": 1.0, "refractory": 0.001}
    several, one = simulation_of(3, **settings), simulation_of(1, **settings)
    every = np.arange(3, dtype=np.int32)
    for _ in range(3):
        alone, among = told_by(one), told_by(several, every)
        np.testing.assert_array_equal(alone[0], among[0])
        several.advance(np.array([[3.0, 0, 0, 1.0], [0, 0, 0, 0], [0, 2.0, 0, -2.0]]), 20)
        one.advance(np.array([[3.0, 0, 0, 1.0]]), 20)
    assert len(among[2]) > len(among[1])


def test_counts_are_those_of_the_events():
    simulation = simulation_of(bins=3)
    told_by(simulation)
    simulation.advance(TURN, 30)
    sensors = simulation.view.events(ONE)
    events = sensors.events_of(0)
    counts = np.zeros((1, 6, SIZE, SIZE), np.uint8)
    sensors.count(np.zeros(1, np.int64), counts)
    part = np.minimum(events["t"] // 20_000, 2)
    expected = np.zeros((6, SIZE, SIZE), int)
    np.add.at(expected, (2 * part + events["p"], events["y"], events["x"]), 1)
    np.testing.assert_array_equal(counts[0], np.minimum(expected, 255))
    assert counts.any(axis=(2, 3)).all()


def test_a_new_episode_begins_anew():
    simulation = simulation_of()
    told_by(simulation)
    simulation.advance(TURN, 20)
    told_by(simulation)
    simulation.reset()
    assert len(told_by(simulation)[0]) == 0
    simulation.advance(np.zeros((1, 4)), 5)
    assert told_by(simulation)[0]["t"].max(initial=0) <= 10_000
