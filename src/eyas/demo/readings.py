"""What the panel shows: the numbers of an instant, as JSON."""

import math
from typing import Any

import numpy as np

from eyas.demo.flight import DemoFlight
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.state.terrain import relief_at
from eyas.engine.targets.catalogue import MODELS, VEHICLE_KINDS, kind_of
from eyas.engine.targets.words import phrases
from eyas.engine.task import reward
from eyas.engine.task.done import DoneReason
from eyas.engine.task.ground import ground_corners
from eyas.engine.task.observe import target_plane
from eyas.lanes import interpreted

_target_plane, _relief_at = interpreted(target_plane), interpreted(relief_at)
_axis_depth, _view_share = interpreted(reward.axis_depth), interpreted(reward.view_share)
_rewarded_size = interpreted(reward.rewarded_size)
_view, _view_discrete = interpreted(reward.view_continuous), interpreted(reward.view_discrete)
_distance = interpreted(reward.distance_continuous)
_distance_discrete = interpreted(reward.distance_discrete)


def readings(flight: DemoFlight) -> dict[str, Any]:
    """Return reward, place, speeds, target and reasons that would end the episode."""
    trackers, cameras, targets, episodes, _ = flight.simulation.snapshot
    rules, terrain = flight.simulation.rules, flight.world.assets.scene.terrain
    x, y = targets.centre[0, :2].tolist()
    position, rotation = cameras.position[0], cameras.rotation[0]
    ground = _target_plane(targets, 0, terrain)
    field = float(cameras.field_of_view[0])
    depth = _axis_depth(position, rotation, ground)
    share = _view_share(position, rotation, depth, ground, _rewarded_size(field, rules))
    view = episodes.view_centre[0]
    offset = math.hypot(x - view[0], y - view[1])
    half = math.tan(0.5 * field)
    seen = ground_corners(position, rotation, (half, half * rules.aspect), ground, 400.0)
    drone, speed = trackers.position[0], trackers.velocity[0]
    return {
        "reward": round(float(episodes.reward[0]), 4),
        "kinds": _kinds(share, offset, depth, flight),
        "p": round(share, 4),
        "offset": round(offset, 2),
        "distance": round(float(np.linalg.norm(targets.centre[0] - drone)), 2),
        "height": round(float(drone[2] - _relief_at(terrain, drone[0], drone[1])), 2),
        "speed": round(math.hypot(speed[0], speed[1]), 2),
        "climb": round(float(speed[2]), 2),
        "yaw_rate": round(math.degrees(trackers.angular_velocity[0, 2]), 1),
        "pitch": round(math.degrees(trackers.gimbal[0, 1]), 1),
        "camera_yaw": round(math.degrees(trackers.gimbal[0, 2]), 1),
        "steps": int(episodes.step_count[0]),
        "time": round(float(episodes.tick[0]) * PHYSICS_STEP, 3),
        "reasons": reasons(flight),
        "drone": [*np.round(drone, 2).tolist(), round(float(trackers.euler[0, 2]), 3)],
        "footprint": np.round(seen[:, :2], 1).tolist(),
        "target": {
            "actor": flight.target,
            "model": MODELS[int(targets.model[0])].name.removesuffix("Simple"),
            "words": _words(flight),
            "parked": flight.target == flight.world.parked,
            "place": [round(x, 2), round(y, 2), round(float(targets.yaw[0]), 3)],
            "speed": round(float(targets.speed[0]), 2),
        },
    }


def _words(flight: DemoFlight) -> str:
    """Return the target as people call it: "a small green car"."""
    models, colours = flight.simulation.looks_around(0)
    model = int(models[0, flight.target])
    known = phrases(model, colours[0, flight.target].tolist())
    drives = kind_of(model) in VEHICLE_KINDS  # of others, the first says enough
    return known[min(drives, len(known) - 1)]


def _kinds(share: float, offset: float, depth: float, flight: DemoFlight) -> dict[str, float]:
    """Return the reward of each of the four kinds."""
    rules = flight.simulation.rules
    if not depth > 0.0:
        return dict.fromkeys(("view", "view_discrete", "distance", "distance_discrete"), 0.0)
    return {
        "view": round(_view(share, rules), 4),
        "view_discrete": _view_discrete(share),
        "distance": round(_distance(offset, rules), 4),
        "distance_discrete": _distance_discrete(offset, rules),
    }


def reasons(flight: DemoFlight) -> list[str]:
    """Return every reason for which a training episode would have ended now."""
    _, _, targets, episodes, _ = flight.simulation.snapshot
    rules = flight.simulation.rules
    found = [DoneReason(int(episodes.breach[0]))]
    found += [DoneReason.TARGET_LOST] * bool(targets.lost[0])
    found += [DoneReason.NO_REWARD] * bool(episodes.no_reward_count[0] > rules.no_reward_steps)
    found += [DoneReason.STEP_LIMIT] * bool(episodes.step_count[0] >= rules.total_steps)
    return [reason.name.lower() for reason in found if reason is not DoneReason.NONE]


def traffic(flight: DemoFlight) -> list[list[float]]:
    """Return east, north [m], heading [rad], number and length [m] of each actor in the world."""
    state, model = flight.simulation.actors_around(0)
    here = np.flatnonzero(state.present[0])
    lengths = [MODELS[index].size[0] for index in model[here].tolist()]
    place = np.column_stack([state.position[0, here, :2], state.yaw[0, here], here, lengths])
    listed: list[list[float]] = np.round(place, 2).tolist()
    return listed
