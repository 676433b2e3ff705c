import pytest

from eyas.dat.settings.adapter import from_original, to_original
from eyas.engine.core.errors import ConfigError


@pytest.mark.parametrize("value", [0, -3, 1.0, 1e9])
def test_other_params_may_be_out_of_range_then_and_are_written_back(value):
    config = from_original({"Other_Params": {"max_obj_num": value, "obj_import_interval": value}})
    written = to_original(config)["Other_Params"]
    assert (written["max_obj_num"], written["obj_import_interval"]) == (value, value)
    followed = {"Tracking_Object": "Pedestrian", "Other_Params": {"max_obj_num": value}}
    with pytest.raises(ConfigError, match=r"^Other_Params\.max_obj_num: .* a whole number"):
        from_original(followed)
    with pytest.raises(ConfigError, match=r"^Other_Params\.max_obj_num: 'a' is not .*: a number"):
        from_original({"Other_Params": {"max_obj_num": "a"}})
