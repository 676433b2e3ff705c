import logging
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from eyas.engine.core.cache.entries import entries
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.core.installed import install_command
from eyas.engine.state.roads import RoadGraph
from eyas.engine.traffic import library
from eyas.engine.traffic.config import Demand, TrafficConfig, VehicleType
from eyas.engine.traffic.library import CANONICAL_SEED, find_recording
from eyas.engine.traffic.network import graph_hash
from eyas.engine.traffic.record import record, resolved
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.recording_file import save, to_bytes

CARS = TrafficConfig(max_vehicles=5)
BUSES = TrafficConfig(max_vehicles=4, vehicle_type=VehicleType.BUS)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("EYAS_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache" / "traffic"


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


def without_sumo(purpose: str = "") -> str:
    raise MissingExtraError("traffic", "sumo")


@pytest.fixture
def copied(
    grid: RoadGraph, wandering: TrafficRecording, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """A recording of `CARS` that some other SUMO made, in the cache of a machine without SUMO."""
    origin = replace(
        wandering.provenance,
        graph_hash=graph_hash(grid),
        config=resolved(CARS, CANONICAL_SEED),
        sumo_version="0.1.2",
        eyas_version="0.0.0",
    )
    made = replace(wandering, provenance=origin)
    with monkeypatch.context() as elsewhere:
        elsewhere.setattr(library, "sumo_version", lambda _: "0.1.2")
        elsewhere.setattr(library, "record", lambda *_, **__: made)
        find_recording(grid, CARS, duration=5.0)
    monkeypatch.setattr(library, "sumo_version", without_sumo)
    monkeypatch.setattr(library, "record", without_sumo)
    monkeypatch.setitem(sys.modules, "sumo", None)
    monkeypatch.setitem(sys.modules, "libsumo", None)
    (file,) = cache.iterdir()
    return file


def test_a_cached_recording_needs_no_sumo_and_not_its_version(grid: RoadGraph, copied: Path):
    os.utime(copied, (0, 0))
    found = find_recording(grid, CARS, duration=5.0)
    assert found.provenance.sumo_version == "0.1.2"
    assert copied.stat().st_mtime > 0  # it was used
    assert [entry.kind for entry in entries(copied.parents[1])] == [EntryKind.TRAFFIC]
    with pytest.raises(MissingExtraError):
        find_recording(grid, CARS, duration=6.0)


def test_a_recording_under_the_name_of_another_is_not_used(grid: RoadGraph, copied: Path):
    with pytest.raises(MissingExtraError):
        find_recording(grid, CARS.model_copy(update={"max_speed": 9.0}), duration=5.0)
    other = resolved(CARS.model_copy(update={"max_speed": 9.0}), CANONICAL_SEED)
    copied.rename(library._cache_file(grid, other, 5.0, ()))
    with pytest.raises(MissingExtraError):
        find_recording(grid, CARS.model_copy(update={"max_speed": 9.0}), duration=5.0)


def test_a_recording_is_used_where_the_cache_cannot_be_written(
    grid: RoadGraph,
    wandering: TrafficRecording,
    cache: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
):
    cache.parent.write_text("in the way")
    monkeypatch.setattr(library, "sumo_version", lambda _: "0.1.2")
    monkeypatch.setattr(library, "record", lambda *_, **__: wandering)
    assert to_bytes(find_recording(grid, CARS, duration=5.0)) == to_bytes(wandering)
    assert caplog.messages[-1].startswith("the recording is used but could not be cached: ")


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_routes_that_need_not_be_new_are_made_anew_where_none_fit(
    grid: RoadGraph, caplog: pytest.LogCaptureFixture
):
    kept = CARS.model_copy(update={"update_routes": False})
    first = find_recording(grid, kept, duration=5.0)
    assert len(caplog.messages) == 1
    assert caplog.messages[0].startswith("recording 5 s of traffic on 'grid' with SUMO")
    assert "although traffic.update_routes (Sumo_Params.rou_update) is false" in caplog.messages[0]
    assert to_bytes(find_recording(grid, kept, duration=5.0)) == to_bytes(first)
    assert to_bytes(find_recording(grid, CARS, duration=5.0)) == to_bytes(first)
    assert len(caplog.messages) == 1


@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_one_line_says_what_has_changed(
    grid: RoadGraph, tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    shipped = [tmp_path / "cars.npz", tmp_path / "buses.npz"]
    save(record("grid", 0, grid, CARS, 5.0, CANONICAL_SEED), shipped[0])
    save(record("grid", 0, grid, BUSES, 5.0, CANONICAL_SEED), shipped[1])
    for same in (CARS, CARS.model_copy(update={"colour": (1.0, 0.0, 0.0), "group_size": 9}), BUSES):
        find_recording(grid, same, duration=5.0, shipped=shipped)
    assert caplog.messages == []
    slow = BUSES.model_copy(update={"max_speed": 9.0})
    find_recording(grid, slow, duration=5.0, shipped=shipped)
    (line,) = caplog.messages
    assert ", for traffic.max_speed is 9.0 (shipped: 20.0); kept for the same settings in " in line


WITHOUT_SUMO = """
import importlib.metadata, sys
def version(name, known=importlib.metadata.version):
    if name == "eclipse-sumo":
        raise importlib.metadata.PackageNotFoundError(name)
    return known(name)
importlib.metadata.version = version
sys.modules.update(dict.fromkeys(["libsumo", "sumo", "sumolib", "traci"]))
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import find_recording
from eyas.maps.citystreet import CITYSTREET
try:
    find_recording(CITYSTREET.roads(0), TrafficConfig(max_speed=10.0, update_routes=False))
except MissingExtraError as error:
    print(error)
"""


def test_without_sumo_one_line_says_what_to_install():
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_SUMO], capture_output=True, text=True, check=True
    )
    (line,) = done.stdout.splitlines()
    assert line.startswith(
        "new traffic, as no recording fits the settings, needs the extra 'sumo': "
        f"{install_command('sumo')}"
    )
    assert done.stderr == ""


def test_a_group_that_is_too_small_is_raised_in_one_line(
    grid: RoadGraph, wandering: TrafficRecording, tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    small = TrafficConfig(demand=Demand.RESPAWN, group_size=2)
    origin = replace(
        wandering.provenance, graph_hash=graph_hash(grid), config=resolved(small, 1, trackers=4)
    )
    save(replace(wandering, provenance=origin), tmp_path / "twelve.npz")
    shipped = [tmp_path / "twelve.npz"]
    found = find_recording(grid, small, trackers=4, duration=20.0, shipped=shipped)
    assert found.provenance.config.group_size == 12
    assert caplog.messages == [
        "traffic.group_size (Sumo_Params.car_group_num): 2 raised to 12, 3 for each tracker, "
        "of which a world has 4"
    ]
    enough = small.model_copy(update={"group_size": 12})
    assert find_recording(grid, enough, trackers=4, duration=20.0, shipped=shipped)
    assert len(caplog.messages) == 1


def test_a_named_recording_of_another_map_is_refused(
    grid: RoadGraph, wandering: TrafficRecording, tmp_path: Path
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
