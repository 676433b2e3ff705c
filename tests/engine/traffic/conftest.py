from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.state.motion import Motion
from eyas.engine.state.roads import RoadEdge, RoadGraph, RoadNode
from eyas.engine.state.terrain import Terrain
from eyas.engine.traffic.config import TrafficConfig, VehicleType
from eyas.engine.traffic.recording import Provenance, TrafficRecording
from eyas.engine.traffic.sumo_install import import_libsumo

from ...kit.motions import recorded_motion

MakeRecording = Callable[..., TrafficRecording]


@pytest.fixture(scope="session")
def grid() -> RoadGraph:
    """Four by four crossings, 120 m apart, all roads two-way."""
    at = [(i, j) for i in range(4) for j in range(4)]
    nodes = tuple(RoadNode(f"n{i}{j}", 120.0 * i - 180.0, 120.0 * j - 180.0) for i, j in at)
    pairs = [
        (f"n{i}{j}", f"n{i + a}{j + b}")
        for i, j in at
        for a, b in ((1, 0), (0, 1))
        if i + a < 4 and j + b < 4
    ]
    both = [pair for a, b in pairs for pair in ((a, b), (b, a))]
    return RoadGraph("grid", 0, nodes, tuple(RoadEdge(f"{a}-{b}", a, b) for a, b in both))


@pytest.fixture(scope="session")
def make_recording() -> MakeRecording:
    """Builds a recording from paths (S, A, 2) at 10 Hz."""

    def make(
        position: NDArray[np.float64],
        yaw: NDArray[np.float64] | None = None,
        present: NDArray[np.bool_] | None = None,
    ) -> TrafficRecording:
        shape = position.shape[:2]
        return TrafficRecording(
            rate=10.0,
            position=np.rint(position * 100) * 0.01,
            yaw=np.zeros(shape) if yaw is None else np.rint(yaw * 1000) * 0.001,
            present=np.ones(shape, np.bool_) if present is None else present,
            vehicle_types=(VehicleType.PASSENGER,) * shape[1],
            vehicle_length=np.full(shape[1], 5.0),
            provenance=Provenance(
                map_name="grid",
                map_seed=3,
                graph_hash="0123456789abcdef",
                config=TrafficConfig(max_vehicles=shape[1], seed=1),
                duration=(shape[0] - 1) / 10.0,
                warm_up=60.0,
                options=("--some", "option"),
                sumo_version="1.28.0",
                eyas_version="0.1.0",
            ),
        )

    return make


@pytest.fixture(scope="session")
def wandering(make_recording: MakeRecording) -> TrafficRecording:
    """Two cars for 20 s; actor 2 is one car until 5 s and another, far away, from 6 s to 15 s."""
    time = np.arange(201) / 10.0
    first = np.stack([8.0 * time, 3.0 * np.sin(0.4 * time)], axis=-1)
    second = np.stack([100.0 - 5.0 * time, 0.2 * time**2], axis=-1)
    third = np.where((time < 5.5)[:, None], first + 50.0, second - [800.0, 900.0])
    present = np.ones((201, 3), np.bool_)
    present[51:60, 2] = False
    present[151:, 2] = False
    drift = np.arctan2(1.2 * np.cos(0.4 * time), 8.0)
    yaw = np.stack([drift, np.arctan2(0.4 * time, -5.0), drift], axis=-1)
    yaw[:, 2] = np.where(time < 5.5, drift, yaw[:, 1])
    return make_recording(np.stack([first, second, third], axis=1), yaw, present)


@pytest.fixture(scope="session")
def flat_motion() -> Callable[[TrafficRecording], Motion]:
    """Makes motion of a recording on a flat map, all actors of kind 0."""

    def make(recording: TrafficRecording) -> Motion:
        return recorded_motion(recording, Terrain.flat(0.0), np.zeros(recording.actors, np.int32))

    return make


@pytest.fixture(scope="session")
def sumo() -> None:
    """Skips a test, with the reason, where SUMO cannot be imported."""
    try:
        import_libsumo()
    except MissingExtraError as error:
        pytest.skip(str(error))
