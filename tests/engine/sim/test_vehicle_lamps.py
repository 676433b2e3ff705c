"""Brake lamps and indicators in pictures, lists of moving parts and labels."""

from pathlib import Path

import numpy as np
import pytest

from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.label import label_of
from eyas.engine.exports.writer import Episode
from eyas.engine.render.kernels.surface.signalling import BRAKING
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.sim.views.visible_actors import VisibleActors
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.motion import Lamp
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.looks import LookSampler
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.lamps import shining
from eyas.engine.world.config import WorldConfig
from eyas.lanes import interpreted

WORKING = TrafficConfig(signals="amber", lamps="working")

EPISODE = Episode(Path(), "0", 0, 64, 48, np.eye(3), 25.0)


def assets(weather: str, traffic: TrafficConfig = WORKING):
    return load_assets(WorldConfig(weather=weather), traffic)


def braking_in(motion) -> tuple[float, int]:
    """A time at which an actor brakes from a good speed."""
    speed = np.hypot(motion.table["velocity_x"], motion.table["velocity_y"])
    row, actor = np.argwhere((motion.lamps == Lamp.BRAKE) & (speed > 6.0))[50].tolist()
    return row / motion.rate, actor


def behind(world: StillWorld, time: float, actor: int) -> Views:
    state = world.actors(time)
    yaw = float(state.yaw[0, actor])
    ahead, left = np.array([np.cos(yaw), np.sin(yaw), 0]), np.array([-np.sin(yaw), np.cos(yaw), 0])
    eye = state.position[0, actor] - 8.0 * ahead + [0, 0, 1.2]
    axes = np.stack([ahead, left, np.array([0.0, 0.0, 1.0])], axis=-1)
    one = np.zeros(1, np.int32)
    return Views(eye[None], axes[None], one, one - 1, 0.8, tent=False)


@pytest.mark.parametrize("weather", ["day", "night"])
def test_a_braking_car_is_seen_to_brake(weather):
    working = StillWorld(assets(weather))
    dark = StillWorld(assets(weather, TrafficConfig(signals="amber", lamps="dark")))
    time, actor = braking_in(working.assets.traffic.motion)
    views, shown = behind(working, time, actor), []
    for world in (dark, working):
        picture = Picture.create(1, 96, 128, object_id=True)
        world.draw(views, time, picture)
        shown.append(picture.rgb[0].astype(int))
    changed = (shown[1] != shown[0]).any(axis=2)
    own = changed & (picture.object_id[0] == ACTOR_OBJECT + actor)
    red, green = shown[1][own][:, 0], shown[1][own][:, 1]
    assert ((red > 240) & (red > green + 80)).sum() > 20
    lit = changed & (picture.object_id[0] < ACTOR_OBJECT)
    if weather == "day":
        assert not lit.any()
    else:  # they also light the road behind it
        assert (shown[1][lit][:, 0] > shown[0][lit][:, 0]).sum() > 100


def test_the_lists_of_several_worlds_hold_the_lamps_of_each():
    town = assets("day")
    motion = town.traffic.motion
    worlds, times = np.arange(3), np.array([20.0, 20.3, 71.02])
    models, colours = LookSampler(motion.kind).sample(np.random.default_rng(1))
    looks = Looks(np.stack([models] * 3), np.stack([colours] * 3))
    everyone = VisibleActors(motion, town.rigs, looks, np.full(len(town.rigs.casts), 1e6))
    cameras = CameraState(np.zeros((3, 3)), np.stack([np.eye(3)] * 3), np.full(3, 1.0))
    listed = everyone.of(worlds, times, None, cameras, 0.75)
    lamps, ids = listed.lamps.copy(), listed.object_id.copy()
    at, lit = interpreted(shining), 0
    for world, time in enumerate(times.tolist()):
        used = np.flatnonzero(listed.part[world] >= 0)
        for slot in used.tolist():
            assert lamps[world, slot] == at(motion, int(ids[world, slot]) - ACTOR_OBJECT, time)
        lit += np.count_nonzero(lamps[world, used] & BRAKING == BRAKING)
    assert lit > 0


def test_labels_tell_what_a_car_signals():
    simulation = build_simulation(SimConfig(traffic=WORKING), together(1))
    simulation.reset()
    motion, told = simulation.traffic.motion, set()
    for _ in range(30):
        simulation.advance(np.zeros((1, 4)), 100)
        picture = Picture.create(1, 48, 64, subject=True)
        simulation.draw(np.zeros(1, np.int32), picture)
        moment = moment_of(simulation, 0, picture, 0)
        frame = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None))
        label = label_of(frame, EPISODE)
        row = int(frame.time * motion.rate + 1e-9)
        state = int(motion.lamps[row, frame.target.object_id - ACTOR_OBJECT])
        assert label.get("target_brake", False) == bool(state & Lamp.BRAKE)
        side = {0: None, 2: "left", 4: "right"}[state & ~Lamp.BRAKE]
        assert label.get("target_indicator") == side
        told.add(state)
    assert len(told) > 1
