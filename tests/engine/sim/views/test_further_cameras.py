"""Cameras beside a tracker's own: where they are, what they show, what they do not change."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.optics.pinhole import project
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.trackers.kinds import tracker_of

SIZE = 60, 80


def _simulation(config: SimConfig, assets, *cameras: dict[str, object]) -> Simulation:
    camera = config.camera.model_dump() | {"height": SIZE[0], "width": SIZE[1]}
    further = [{"height": SIZE[0], "width": SIZE[1], **each} for each in cameras]
    own = SimConfig(**(config.model_dump() | {"camera": camera, "cameras": further}))
    made = Simulation(own, assets, tracker_of(own.tracker), each_alone(3))
    made.reset()
    made.carry(5)
    return made


def _drawn(simulation: Simulation, name: str | None = None) -> Picture:
    everyone = np.arange(simulation.count, dtype=np.int32)
    picture = Picture.create(simulation.count, *SIZE, depth=True, subject=True)
    if name is None:
        simulation.view.draw(everyone, picture)
    else:
        simulation.view.further[name].draw(everyone, picture)
    return picture


def test_a_camera_in_the_same_place_shows_the_same(config, assets):
    simulation = _simulation(config, assets, {"name": "twin"})
    own, twin = _drawn(simulation), _drawn(simulation, "twin")
    for field in dataclasses.fields(Picture):
        one, other = getattr(own, field.name), getattr(twin, field.name)
        assert one is None or np.array_equal(one, other), field.name


def test_what_a_stereo_pair_sees_is_shifted_by_focal_length_times_baseline_over_depth(
    config, assets
):
    simulation = _simulation(config, assets, {"name": "right", "mount": {"y": -0.5}})
    left, right = _drawn(simulation), _drawn(simulation, "right")
    cameras = simulation.snapshot.cameras
    centre, others = simulation.snapshot.targets.centre, simulation.view.further["right"].cameras
    for n in range(simulation.count):
        here, there = (
            project(centre[n], c.position[n], c.rotation[n], SIZE[1], SIZE[0], c.field_of_view[n])
            for c in (cameras, others)
        )
        focal = 0.5 * SIZE[1] / np.tan(0.5 * cameras.field_of_view[n])
        assert here[0] - there[0] == pytest.approx(focal * 0.5 / here[2], rel=1e-9)
        assert here[1] == pytest.approx(there[1], abs=1e-9)
        shift = (left.subject_box[n] - right.subject_box[n])[[0, 2]]
        assert shift.mean() == pytest.approx(focal * 0.5 / here[2], abs=1.6)


def test_a_camera_on_the_body_looks_where_the_body_looks(config, assets):
    simulation = _simulation(
        config, assets, {"name": "back", "on": "body", "mount": {"yaw": np.pi, "x": -0.1}}
    )
    _drawn(simulation, "back")
    back, trackers = simulation.view.further["back"].cameras, simulation.snapshot.trackers
    for n in range(simulation.count):
        yaw = trackers.euler[n, 2]
        assert back.rotation[n, :, 0] == pytest.approx([-np.cos(yaw), -np.sin(yaw), 0.0], abs=1e-6)
        behind = back.position[n] - trackers.position[n]
        assert behind == pytest.approx([-0.1 * np.cos(yaw), -0.1 * np.sin(yaw), 0.0], abs=1e-6)


def test_further_cameras_change_nothing_else(config, assets):
    plain = _simulation(config, assets)
    more = _simulation(
        config, assets, {"name": "wide", "field_of_view": {"uniform": [1.5, 2.0]}, "on": "body"}
    )
    assert np.array_equal(_drawn(plain).rgb, _drawn(more).rgb)
    fields = more.view.further["wide"]
    fields.place()
    assert len({*fields.cameras.field_of_view.tolist()}) == 3
    assert ((fields.cameras.field_of_view > 1.5) & (fields.cameras.field_of_view < 2.0)).all()


def test_names_are_checked():
    with pytest.raises(ConfigError, match="names of their own"):
        SimConfig(cameras=[{"name": "left"}, {"name": "left"}])
    with pytest.raises(
        ConfigError, match=r"^cameras\.0\.name: 'Left Eye' is not allowed: must be a small letter"
    ):
        SimConfig(cameras=[{"name": "Left Eye"}])
