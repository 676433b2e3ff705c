"""Small worlds of a few solids, a terrain and vehicles, around trackers at known poses."""

from dataclasses import replace

import numpy as np

from eyas.engine.sensors.obstacles import obstacles_of, solids_of
from eyas.engine.state.motion import SAMPLE, SampledMotion
from eyas.engine.state.scene import Colliders, ObjectClass, Scene
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.targets.catalogue import model_index
from eyas.engine.traffic.trailer import BUMPER_AHEAD, TAIL_BEHIND

GROUND, WALL, POLE = 0, 1, 2


def scene_of(prisms=(), cylinders=(), relief=None):
    """A scene of prisms (outline, bottom, top) and cylinders (x, y, radius, bottom, top)."""
    outlines = [np.array(outline, np.float64).reshape(-1, 2) for outline, _, _ in prisms]
    rounds = np.array(cylinders, np.float64).reshape(-1, 5)
    colliders = Colliders(
        prism_points=np.concatenate([np.zeros((0, 2)), *outlines]),
        prism_first=np.cumsum([0, *map(len, outlines)]).astype(np.int32),
        prism_bottom=np.array([low for _, low, _ in prisms], np.float64),
        prism_top=np.array([high for _, _, high in prisms], np.float64),
        prism_object=np.full(len(prisms), WALL, np.int32),
        cylinder_centre=rounds[:, :2],
        cylinder_radius=rounds[:, 2],
        cylinder_bottom=rounds[:, 3],
        cylinder_top=rounds[:, 4],
        cylinder_object=np.full(len(rounds), POLE, np.int32),
    )
    terrain = Terrain.flat(-0.1) if relief is None else relief
    classes = [ObjectClass.GROUND, ObjectClass.BUILDING, ObjectClass.POLE]
    return replace(
        Scene.empty(),
        colliders=colliders,
        terrain=terrain,
        object_class=np.array(classes, np.int32),
    )


def motion_of(*cars, hitch=0.0):
    """Motion of cars that drive straight ahead for a second: (x, y, yaw, speed) at time 0."""
    table = np.zeros((11, max(len(cars), 1)), SAMPLE)
    for actor, (x, y, yaw, speed) in enumerate(cars):
        times = np.linspace(0.0, 1.0, 11)
        table["x"][:, actor] = x + speed * np.cos(yaw) * times
        table["y"][:, actor] = y + speed * np.sin(yaw) * times
        table["velocity_x"][:, actor] = speed * np.cos(yaw)
        table["velocity_y"][:, actor] = speed * np.sin(yaw)
        table["yaw"][:, actor], table["present"][:, actor] = yaw, 1.0
    table["hitch"] = hitch
    return SampledMotion(table, np.zeros(table.shape[1], np.int32), 10.0).packed()


def folded_truck():
    """A truck that looks east, its kingpin at the origin; its trailer looks north."""
    yaw = np.arctan2(TAIL_BEHIND, BUMPER_AHEAD)
    x, y = 0.5 * BUMPER_AHEAD + np.cos(yaw), -0.5 * TAIL_BEHIND + np.sin(yaw)
    return motion_of((x, y, yaw, 0.0), hitch=0.5 * np.pi)


def build(
    *poses,
    prisms=(),
    cylinders=(),
    relief=None,
    cars=(),
    model="BmwX5Simple",
    bodies=False,
    folded=False,
):
    """Return a snapshot of trackers at poses (x, y, z, yaw) in one world, and their obstacles.

    Its cars are of a model; if `folded`, there is the truck of `folded_truck` instead.
    """
    snapshot = Snapshot.create(len(poses))
    for n, (x, y, z, yaw) in enumerate(poses):
        snapshot.trackers.position[n] = x, y, z
        snapshot.trackers.euler[n, 2] = yaw
        snapshot.trackers.orientation[n] = np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)
    motion = folded_truck() if folded else motion_of(*cars)
    scene = scene_of(prisms, cylinders, relief)
    number = model_index("TruckTrailerSimple" if folded else model)
    models = np.full((1, motion.table.shape[1]), number, np.int32)
    world = np.zeros(len(poses), np.int32)
    trackers = snapshot.trackers if bodies else None
    solids = solids_of(scene)
    return snapshot, obstacles_of(solids, scene.terrain, motion, world, models, trackers)
