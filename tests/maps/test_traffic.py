"""Recording many seeds at once, and what is said of a recording."""

from pathlib import Path

import pytest

from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.traffic.config import Mix, TrafficConfig
from eyas.engine.traffic.sumo_install import import_libsumo
from eyas.engine.world.config import WorldConfig
from eyas.maps.citystreet import CITYSTREET
from eyas.maps.traffic import recording
from eyas.maps.traffic.about import about, lines_of

MIXED = TrafficConfig(vehicle_type=Mix(passenger=3, bus=1), max_vehicles=8)


@pytest.fixture(scope="module")
def sumo():
    try:
        import_libsumo()
    except Exception as error:
        pytest.skip(str(error))


@pytest.mark.slow
@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_several_processes_write_the_same_files_as_one(tmp_path: Path):
    for folder, workers in (("one", 1), ("two", 2)):
        recording.run(
            WorldConfig(), MIXED, 5.0, tmp_path / folder, seeds=(4, 7, 9), workers=workers
        )
    names = [f"citystreet-{seed}-mixed.npz" for seed in (4, 7, 9)]
    one, two = ([(tmp_path / d / name).read_bytes() for name in names] for d in ("one", "two"))
    assert one == two
    assert len(set(one)) == 3
    with pytest.raises(OutputError, match="already exists"):
        recording.run(WorldConfig(), MIXED, 5.0, tmp_path / "one", seeds=(4,))


@pytest.mark.slow
@pytest.mark.sumo
@pytest.mark.usefixtures("sumo")
def test_an_error_in_a_process_is_told_as_in_this_one(tmp_path: Path):
    many = TrafficConfig(max_vehicles=400, vehicle_type=Mix(trailer=1))
    with pytest.raises(ConfigError, match=r"^traffic\.max_vehicles: 400 is too many"):
        recording.run(WorldConfig(), many, 1.0, tmp_path, seeds=(1, 2), workers=2)


def test_info_tells_origin_and_figures():
    shipped = {file.name: Path(str(file)) for file in CITYSTREET.shipped_traffic()}
    lines = list(lines_of(about(shipped["traffic-mixed.npz"])))
    assert lines[0].startswith("map: citystreet, seed 0 (roads ")
    assert lines[1] == (
        'traffic: demand=keep_alive vehicle_type={"passenger": 0.7, "bus": 0.1, "truck": 0.1, '
        '"trailer": 0.05, "motorcycle": 0.05} seed=1 signals="amber"'
    )
    assert "SUMO 1." in lines[2]
    assert lines[3].startswith("duration: 1260 s at 10 Hz")
    assert [line.split()[1] for line in lines[4:10]] == ["28", "4", "4", "2", "2", "40"]
    assert "of which 40 last 60 s or longer and 40 the whole recording" in lines[10]
    groups = list(lines_of(about(shipped["traffic-groups-of-12.npz"])))
    assert groups[4].startswith("passenger: 40 at most, 15.0 on average; 12.7 m/s on average")
    assert "standing 0.4 % of the time" in groups[4]
