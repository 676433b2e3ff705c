import logging
from dataclasses import replace
from pathlib import Path

import platformdirs
import pytest

from eyas.core.errors import ConfigError, DataFileError
from eyas.state.roads import RoadGraph
from eyas.traffic.config import TrafficConfig
from eyas.traffic.library import find_recording
from eyas.traffic.network import graph_hash
from eyas.traffic.recording import Recording
from eyas.traffic.recording_file import save, to_bytes

CARS = TrafficConfig(max_vehicles=5)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda name: str(tmp_path / name))
    return tmp_path / "eyas" / "traffic"


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_what_does_not_exist_is_recorded_once(
    grid: RoadGraph, cache: Path, caplog: pytest.LogCaptureFixture
):
    with caplog.at_level(logging.WARNING, "eyas"):
        first = find_recording(grid, CARS, duration=10.0)
        second = find_recording(grid, CARS, duration=10.0)
    assert to_bytes(first) == to_bytes(second)
    assert len(caplog.messages) == 1
    assert caplog.messages[0].startswith("recording 10 s of traffic on 'grid' with SUMO")
    (file,) = cache.iterdir()
    file.write_bytes(file.read_bytes()[:500])
    assert to_bytes(find_recording(grid, CARS, duration=10.0)) == to_bytes(first)


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
@pytest.mark.parametrize("change", [{"seed": 2}, {"max_speed": 9.0}, {"max_vehicles": 4}])
def test_other_settings_are_another_recording(
    grid: RoadGraph, cache: Path, change: dict[str, float]
):
    find_recording(grid, CARS, duration=5.0)
    find_recording(grid, CARS.model_copy(update=change), duration=5.0)
    assert len(list(cache.iterdir())) == 2


def test_recording_can_be_forbidden(grid: RoadGraph, cache: Path):
    with pytest.raises(ConfigError, match=r"^traffic\.update_routes: false, but no recording"):
        find_recording(grid, CARS.model_copy(update={"update_routes": False}))
    assert not cache.exists()


def test_a_named_recording_of_another_map_is_refused(
    grid: RoadGraph, wandering: Recording, tmp_path: Path
):
    save(wandering, tmp_path / "mine.npz")
    config = TrafficConfig(recording=str(tmp_path / "mine.npz"))
    with pytest.raises(DataFileError, match=r"mine\.npz: the recording is"):
        find_recording(grid, config)
    origin = replace(wandering.provenance, graph_hash=graph_hash(grid))
    save(replace(wandering, provenance=origin), tmp_path / "mine.npz")
    assert find_recording(grid, config).actors == 3


def test_a_named_recording_must_exist(grid: RoadGraph, tmp_path: Path):
    with pytest.raises(DataFileError, match=r"missing\.npz: cannot read"):
        find_recording(grid, TrafficConfig(recording=str(tmp_path / "missing.npz")))
