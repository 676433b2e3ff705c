import pytest

from eyas.core.errors import ConfigError, NotInThisVersionError
from eyas.settings.config import EyasConfig
from eyas.settings.legacy.adapter import from_legacy, to_legacy
from eyas.settings.version_check import require_supported


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"Tracking_Object": "Mantis"}, r"target \(Tracking_Object\): 'Mantis': "),
    ],
)
def test_parts_that_come_later_are_named_in_both_notations(values, line):
    with pytest.raises(NotInThisVersionError, match=rf"^{line}.* is not in this version yet$"):
        require_supported(from_legacy(values))


def test_other_params_refuse_no_run_that_follows_a_vehicle():
    every = {
        "max_obj_num": 5,
        "obj_import_interval": 1.0,
        "import_group_num": 2,
        "obj_edge_distribution_random": True,
        "obj_edge_distribution_multilateral": True,
        "obj_edge_distribution_fixed": 3,
        "obj_edge_distribution_max": 12,
        "obj_edge_distribution_min": -4,
    }
    require_supported(from_legacy({"Other_Params": every}))


@pytest.mark.parametrize("value", [0, -3, 1.0, 1e9])
def test_other_params_may_be_out_of_range_then_and_are_written_back(value):
    config = from_legacy({"Other_Params": {"max_obj_num": value, "obj_import_interval": value}})
    require_supported(config)
    written = to_legacy(config)["Other_Params"]
    assert (written["max_obj_num"], written["obj_import_interval"]) == (value, value)
    followed = {"Tracking_Object": "Pedestrian", "Other_Params": {"max_obj_num": value}}
    with pytest.raises(ConfigError, match=r"^Other_Params\.max_obj_num: .* a whole number"):
        from_legacy(followed)
    with pytest.raises(ConfigError, match=r"^Other_Params\.max_obj_num: 'a' is not .*: a number"):
        from_legacy({"Other_Params": {"max_obj_num": "a"}})


def test_defaults_ports_and_modes_are_supported():
    require_supported(EyasConfig())
    require_supported(
        from_legacy({"Simulation_Mode": "train", "Config_Agen_Num_Port": 35531, "Socket_Ip": "::1"})
    )
