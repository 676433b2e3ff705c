"""A recording: SUMO's vehicle poses in whole centimetres and milliradians, with provenance."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.traffic.config import TrafficConfig, VehicleType

POSITION_UNIT = 0.01  # Positions are whole multiples of this [m]

ANGLE_UNIT = 0.001  # Yaws are whole multiples of this [rad]


@dataclass(frozen=True, slots=True)
class Provenance:
    """All inputs of a recording. Recordings with equal provenance are equal."""

    map_name: str
    map_seed: int
    graph_hash: str  # Hash of the road graph the vehicles drove on
    config: TrafficConfig  # Settings of the traffic; `group_size` and `seed` are numbers
    duration: float  # [s]
    warm_up: float  # Simulated time before the recording began [s]
    options: tuple[str, ...]  # SUMO's options
    sumo_version: str  # Empty: SUMO has not driven them
    eyas_version: str
    cover: str = ""
    """Digest of the stretches of lanes in which drivers hide; empty where they don't."""


@dataclass(slots=True)
class TrafficRecording:
    """SUMO's poses at a fixed rate. S samples, A actors, world frame.

    With `respawn`, an actor represents several vehicles one after another, as the original reuses
    its nodes; between two vehicles it is absent for at least one sample.
    """

    rate: float
    """Samples per second [Hz]; sample s is at time s / rate."""
    position: NDArray[np.float64]
    """Middle of the vehicle's length, east and north [m], shape (S, A, 2); held while absent."""
    yaw: NDArray[np.float64]
    """Heading without jumps at ±180° [rad], shape (S, A); held while absent."""
    present: NDArray[np.bool_]
    """Whether the actor is in the world, shape (S, A)."""
    vehicle_types: tuple[VehicleType, ...]
    """Class of each actor, which is the class of all vehicles it represents, A."""
    vehicle_length: NDArray[np.float64]
    """SUMO's length of each actor's class [m], shape (A,)."""
    provenance: Provenance
    """Inputs it was made from."""

    @property
    def actors(self) -> int:
        """Number of actors."""
        return int(self.present.shape[1])

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return (len(self.present) - 1) / self.rate


def quantised(values: NDArray[np.float64], unit: float) -> NDArray[np.int64]:
    """Return values [any unit] rounded to whole multiples of `unit`."""
    return np.rint(values / unit).astype(np.int64)


def restored(multiples: NDArray[np.int64], unit: float) -> NDArray[np.float64]:
    """Return the values [any unit] for multiples of `unit` from `quantised`."""
    return multiples.astype(np.float64) * unit


def problem_of(recording: TrafficRecording) -> str:
    """Return what is wrong with a recording that someone else has made; empty if nothing is.

    Kernels index its arrays without checking bounds, so their shapes must fit.
    """
    samples, actors = shape = recording.present.shape
    origin, limit = recording.provenance, 1e6
    texts = (origin.map_name, origin.graph_hash, origin.sumo_version, origin.eyas_version)
    checks = {
        "it is empty": samples > 1 and actors > 0,
        "its arrays have different shapes": recording.position.shape == (*shape, 2)
        and recording.yaw.shape == shape,
        "its rate is not between 0.1 and 1000 Hz": 0.1 <= recording.rate <= 1000.0,
        "its vehicles are not those of its arrays": len(recording.vehicle_types) == actors
        and recording.vehicle_length.shape == (actors,),
        "its vehicles are not between 0 and 100 m long": bool(
            ((recording.vehicle_length > 0.0) & (recording.vehicle_length <= 100.0)).all()
        ),
        "a vehicle is out of the world": bool((abs(recording.position) < limit).all()),
        "a vehicle turns without end": bool((abs(recording.yaw) < limit).all()),
        "its origin is not told in words": all(isinstance(text, str) for text in texts),
    }
    return next((problem for problem, passed in checks.items() if not passed), "")


def check_map(
    origin: Provenance,  # Where the recording comes from
    map_name: str,  # Name of the map in use
    map_seed: int,
    graph_hash: str,  # Hash of its road graph
    source: str,  # Name of the recording for the message, for example its path
) -> None:
    """Reject a recording of other roads.

    Raises:
        DataFileError: The recording was made on other roads.
    """
    if origin.graph_hash == graph_hash:
        return
    if (origin.map_name, origin.map_seed) == (map_name, map_seed):
        reason = f"of an older '{map_name}' (roads {origin.graph_hash[:8]}, now {graph_hash[:8]})"
    else:
        reason = f"of map {origin.map_name!r} with seed {origin.map_seed!r}"
    raise DataFileError(
        f"{source}: the recording is {reason}, but the map is '{map_name}' with seed {map_seed}; "
        "record this map or leave traffic.recording out"
    )
