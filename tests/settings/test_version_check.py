import pytest

from eyas.core.errors import NotInThisVersionError
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import from_legacy
from eyas.settings.version_check import require_supported


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"Tracker_Def": "CAR"}, r"tracker\.kind \(Tracker_Def\): 'car': "),
        (
            {"Drone_Supervisor_Ctrl": False},
            r"tracker\.supervised \(Drone_Supervisor_Ctrl\): false: ",
        ),
        ({"Tracking_Object": "Mantis"}, r"target \(Tracking_Object\): 'Mantis': "),
        ({"Lidar_Enable": True}, r"wire\.lidar \(Lidar_Enable\): true: "),
        (
            {"Other_Params": {"max_obj_num": 3}},
            r"objects\.max_count \(Other_Params\.max_obj_num\): 3: ",
        ),
    ],
)
def test_parts_that_come_later_are_named_in_both_notations(values, line):
    with pytest.raises(NotInThisVersionError, match=rf"^{line}.* is not in this version yet$"):
        require_supported(from_legacy(values))


def test_defaults_ports_and_modes_are_supported():
    require_supported(EyasConfig())
    require_supported(
        from_legacy({"Simulation_Mode": "train", "Config_Agen_Num_Port": 35531, "Socket_Ip": "::1"})
    )
