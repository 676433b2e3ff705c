"""Information of environments besides observation and reward: arrays over N trackers, by name."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.sensors.original import ORIGINAL
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.task.config import Crash
from eyas.engine.task.done import DoneReason
from eyas.engine.task.packet_rows import SENSOR_COLUMNS
from eyas.engine.task.packets import BASIC_COLUMNS, REWARD_COLUMNS

Floats = NDArray[np.float64]
Info = dict[str, Any]
Mask = NDArray[np.bool_]

_SENSORS = tuple(name for sensor in ORIGINAL for name in sensor.parts)
_WHOLE = ("camera_width", "camera_height", "target_direction")
"""Parts of the reward packet that are whole numbers."""

_REWARD = tuple(name for name in REWARD_COLUMNS if name not in (*_WHOLE, "crash"))

_WORDS = {
    "done_reason": [reason.name.lower() for reason in DoneReason],
    "done_state": [reason.original for reason in DoneReason],
    "contact_class": [*(kind.name.lower() for kind in ObjectClass), "drone", "nothing"],
}
"""Words for numbers, by index; the order is that of the enums, which recordings index, too."""


def information(simulation: Simulation) -> Info:
    """Return the state of N trackers by name, in arrays that later steps do not change.

    - the sensors of the basic packet: `position` and `velocity` (GPS), `orientation` and `euler`
      (IMU), `angular_velocity` (gyroscope), `felt_acceleration` (accelerometer);
    - what further sensors read, by the names of their parts (`Sensor.parts`);
    - the reward packet (both: `eyas.engine.task.packets`), with the type of the target as an index
      into `eyas.engine.targets.catalogue.MODELS`;
    - as numbers of `eyas.engine.task.done.DoneReason`, the reason of the end (`done_reason`) and
      the limit that the body violates (`done_state`); the physics steps since the reset (`step`);
    - the seed of the sequence of episodes (`seed`): `reset(seed=...)` begins it again;
    - the values sampled from the `light` settings (factor on the sky, factor on the sun, one over
      the visibility range [1/m]);
    - where `done.crash` means contacts, the place of the last one since the reset (`contact`, world
      frame [m]), the object that was touched (`contact_object`, as in `Picture.object_id`; -1:
      none) and its `ObjectClass` (`contact_class`; `DRONE_CLASS`: another drone; -1: none);
    - the distances that the lidar has measured, if there is one (`lidar` [m], infinity where
      nothing was within range);
    - where the camera's sensor is modelled, exposure time (`exposure_time` [s]) and speed (`iso`)
      of its last picture; 0 before the first;
    - what a tracker tells of itself (`Tracker.told`): of a flown drone with a battery its charge,
      of 1 (`battery`), and its voltage (`battery_voltage` [V]), and
      with `tracker.tells_rotors` the rates that it asks of its rotors (`rotor_command` [rad/s]);
    - the events of the event camera since the last time, if there is one (`events`, for each
      tracker a row for each: column, row, time since the reset [us], and 1 for more light or
      0 for less).
    """
    basic, reward = simulation.packets()
    _, _, targets, episodes, light = simulation.snapshot
    info: Info = {name: basic[:, BASIC_COLUMNS[name]] for name in _SENSORS}
    info |= {name: reward[:, REWARD_COLUMNS[name]] for name in _REWARD}
    info |= {name: reward[:, REWARD_COLUMNS[name]].astype(np.int64) for name in _WHOLE}
    info["crash"] = reward[:, REWARD_COLUMNS["crash"]] != 0.0
    info["target_type"] = targets.model.copy()
    info["step"] = episodes.step_count.copy()
    info["done_reason"] = episodes.reason.copy()
    info["done_state"] = episodes.breach.copy()
    info["seed"] = simulation.seeds
    info["light"] = np.stack(light, axis=1)
    if simulation.config.done.crash is not Crash.ORIGINAL:
        info["contact"] = episodes.contact.copy()
        info["contact_object"] = episodes.contact_object.copy()
        info["contact_class"] = simulation.classes_of(episodes.contact_object)
    if (lidar := simulation.view.lidar) is not None:
        info["lidar"] = lidar.ranges()
    if (exposure := simulation.view.exposure) is not None:
        info["exposure_time"] = exposure.time.copy()
        info["iso"] = exposure.iso.copy()
    if simulation.config.camera.events.enabled:
        info["events"] = _events(simulation)
    for name, values in simulation.readings().items():
        if name in info:
            raise ConfigError(
                f"sensors.further: {name!r} is not allowed as the name of a reading: `info` has one"
            )
        info[name] = values
    return info | simulation.told()


def _events(simulation: Simulation) -> NDArray[np.object_]:
    """Return the events of all trackers, which are different in number."""
    sensors = simulation.view.events(np.arange(simulation.count, dtype=np.int32))
    assert sensors is not None
    told = np.empty(simulation.count, object)
    for tracker in range(simulation.count):
        events = sensors.events_of(tracker)
        told[tracker] = np.stack([events[name].astype(np.int64) for name in "xytp"], axis=1)
    return told


def by_term(terms: dict[str, Floats]) -> Info:
    """Return terms of the reward under the names `reward/<term>`.

    They are not a dictionary of their own, because TorchRL takes only arrays.
    """
    return {f"reward/{name}": values for name, values in terms.items()}


def of_one(info: Info, index: int) -> Info:
    """Return the information of one tracker, with words for its numbers that mean words:
    `done_reason`, `done_state` (the original's), `target_type` (the same) and `contact_class`.
    """
    one = {name: value[index] for name, value in info.items()}
    words = {**_WORDS, "target_type": [model.typename for model in MODELS]}  # users add models
    return one | {name: said[one[name]] for name, said in words.items() if name in one}


def masked(info: Info, mask: Mask) -> Info:
    """Return information with Gymnasium's `_name` for each name: which environments have it."""
    told: Info = {}
    for name, value in info.items():
        told[name] = masked(value, mask) if isinstance(value, dict) else value
        told[f"_{name}"] = mask
    return told


def sensor_state(
    simulation: Simulation,  # N trackers
    out: NDArray[np.float32],  # Shape (N, 19)
) -> None:
    """Write position, velocity, felt acceleration, angular velocity, orientation and Euler angles,
    as the agents see them.
    """
    out[:] = simulation.view.packets()[0][:, SENSOR_COLUMNS]
