"""Labels of trucks whose trailers swing, on the shipped map and traffic."""

from pathlib import Path

import numpy as np
import pytest

from eyas.engine.exports.capture import FrameMoment, frame_of
from eyas.engine.exports.frame import RecordedAction
from eyas.engine.exports.label import label_of
from eyas.engine.exports.writer import Episode
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.targets.catalogue import KINDS, kind_index
from eyas.engine.targets.rig import Rigs, part_library
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import CANONICAL_MIX

SLACK = 0.1  # [m]
EPISODE = Episode(Path(), "DRONE0", 0, 320, 240, np.eye(3), 25.0)


@pytest.fixture(scope="module")
def simulation():
    return build_simulation(
        SimConfig(traffic=TrafficConfig(vehicle_type=CANONICAL_MIX)), together(2)
    )


def bends(simulation, most) -> tuple[int, int]:
    """Return when, and which truck turns at a junction with the largest hitch up to a limit."""
    motion = simulation.traffic.motion.sampled()
    hitch = np.abs(motion.table["hitch"]) * (motion.table["present"] > 0.0)
    hitch[: int(30 * motion.rate)] = hitch[-int(30 * motion.rate) :] = 0.0
    row, actor = np.unravel_index(np.where(hitch <= most, hitch, 0.0).argmax(), hitch.shape)
    return round(row / motion.rate * 500), int(actor)


def labelled(simulation, tick, actor):
    """Return the label of a truck as a target, and as what another tracker sees."""
    simulation.reset()
    simulation.follow(0, actor)
    simulation.snapshot.episodes.tick[:] = tick - 5
    simulation.carry(5)
    picture = Picture.create(2, 48, 64, subject=True, actors=simulation.actors)
    simulation.draw(np.arange(2, dtype=np.int32), picture)
    picture.actor_pixels[:] = 3, 4  # as if every actor was seen
    snapshot = simulation.snapshot
    frames = [
        frame_of(
            FrameMoment(snapshot, snapshot.episodes, simulation.view.actors(n)),
            *(n, picture, n, 0, RecordedAction(-1, None)),
        )
        for n in (0, 1)
    ]
    target, seen = (label_of(frame, EPISODE) for frame in frames)
    return target, next(other for other in seen["others"] if other["id"] == target["target_id"])


def vertices(simulation, actor) -> list[np.ndarray]:
    """Return what is drawn of a truck and its trailer, each with its wheels [m]."""
    actors, _ = simulation.actors_around(0)
    rigs = Rigs(simulation.traffic.motion.kind)
    drawn, levels = rigs.draw_list(1), part_library(rigs.kinds).parts
    rigs.pose(actors, simulation.looks_around(0), drawn)
    slots = range(*rigs.first_slot[actor : actor + 2])
    parts, poses = drawn.part[0, slots], drawn.pose[0, slots].astype(float)
    meshes = [
        levels[part][0].positions @ pose[:, :3].T + pose[:, 3]
        for part, pose in zip(parts, poses, strict=True)
    ]
    first = next(group.first_part for _, group in rigs.casts if actor in group.actor)
    (trailer,) = np.flatnonzero(np.isin(parts - first, KINDS[kind_index("trailer")].trailers))
    return [np.concatenate(meshes[:trailer]), np.concatenate(meshes[trailer:])]


def sides(corners) -> np.ndarray:
    """Return length, width and height of a box as vectors [m], shape (3, 3)."""
    return np.array(corners)[[1, 3, 4]] - corners[0]


def outside(points, corners) -> float:
    """Return how far the farthest point is outside a box [m]."""
    length = np.linalg.norm(sides(corners), axis=1)
    along = (points - np.array(corners[0])) @ (sides(corners) / length[:, None]).T
    return float(np.maximum(-along, along - length).max())


@pytest.mark.slow
@pytest.mark.parametrize("most", [0.3, 1.0])
def test_everything_that_is_drawn_is_in_the_boxes(simulation, most):
    tick, actor = bends(simulation, most)
    target, other = labelled(simulation, tick, actor)
    shown = vertices(simulation, actor)
    yaws = [section["yaw"] for section in target["target_sections"]]
    assert 0.8 * min(most, 0.7) < abs(yaws[1] - yaws[0]) <= most
    for points, section in zip(shown, target["target_sections"], strict=True):
        assert outside(points, section["corners"]) < SLACK
        size = np.linalg.norm(sides(section["corners"]), axis=1)
        assert size == pytest.approx(section["size"], abs=1e-5)
    whole = np.concatenate(shown)
    assert outside(whole, target["target_corners"]) < SLACK
    assert (other["corners"], other["sections"]) == (
        target["target_corners"],
        target["target_sections"],
    )
    # The box around both is no larger than that.
    parts = np.concatenate([section["corners"] for section in target["target_sections"]])
    size = np.linalg.norm(sides(target["target_corners"]), axis=1)
    along = parts @ (sides(target["target_corners"]) / size[:, None]).T
    assert np.ptp(along, axis=0) == pytest.approx(size, abs=1e-5)
    assert size[1] > target["target_size"][1] + 0.5


@pytest.mark.slow
def test_the_box_of_a_straight_truck_is_as_large_as_it_is(simulation):
    motion = simulation.traffic.motion.sampled()
    (actor, *_) = np.flatnonzero(motion.kind == kind_index("trailer")).tolist()
    rows = np.flatnonzero(
        (motion.table["hitch"][:, actor] == 0.0) & (motion.table["present"][:, actor] > 0.0)
    )
    tick = round(rows[rows > 30 * motion.rate][1] / motion.rate * 500)
    target, _ = labelled(simulation, tick, actor)
    corners = np.array(target["target_corners"])
    size = np.linalg.norm(sides(corners), axis=1)
    assert size == pytest.approx(target["target_size"], abs=1e-5)
    assert corners[:4, :2].mean(axis=0) == pytest.approx(target["target_centre"][:2], abs=1e-5)
    for points, section in zip(vertices(simulation, actor), target["target_sections"], strict=True):
        assert section["yaw"] == target["target_yaw"]
        assert outside(points, section["corners"]) < SLACK
