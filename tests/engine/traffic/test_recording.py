import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.traffic.recording import TrafficRecording, check_map


def test_the_map_it_was_recorded_on_is_accepted(wandering: TrafficRecording):
    check_map(wandering.provenance, "grid", 3, "0123456789abcdef", "drive.npz")


def test_another_map_is_refused_with_both_names(wandering: TrafficRecording):
    with pytest.raises(
        DataFileError, match=r"^drive\.npz: .*'grid' with seed 3.*'lake' with seed 0"
    ):
        check_map(wandering.provenance, "lake", 0, "ffff", "drive.npz")


def test_changed_roads_of_the_same_map_are_refused(wandering: TrafficRecording):
    with pytest.raises(DataFileError, match="older 'grid'"):
        check_map(wandering.provenance, "grid", 3, "ffff", "drive.npz")
