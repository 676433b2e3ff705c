import pytest

from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.task.config import DoneConfig, RewardConfig, StartConfig


@pytest.mark.parametrize(
    ("model", "values", "path"),
    [
        (StartConfig, {"pitch": 0.05}, "pitch: 0.05"),
        (StartConfig, {"pitch": {"uniform": [0.5, 4.0]}}, "pitch: "),
        (StartConfig, {"height": {"choice": [20.0, -1.0]}}, "height: "),
        (StartConfig, {"direction": {"mirrored": [0.0, 7.0]}}, "direction: "),
        (StartConfig, {"warm_up_steps": -1}, "warm_up_steps: -1"),
        (RewardConfig, {"cut_off": 1.5}, "cut_off: 1.5"),
        (RewardConfig, {"view_scale": 0.0}, "view_scale: 0.0"),
        (RewardConfig, {"mode": "smooth"}, "mode: 'smooth'"),
        (DoneConfig, {"velocity": 1e12}, "velocity: "),
        (DoneConfig, {"min_height": 60.0}, ""),
        (DoneConfig, {"total_steps": 0}, "total_steps: 0"),
    ],
)
def test_values_out_of_range_are_one_line_with_their_path(model, values, path):
    with pytest.raises(ConfigError) as caught:
        validated(model, values)
    assert str(caught.value).startswith(path)
    assert "not allowed" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_published_settings_are_allowed():
    assert validated(
        StartConfig,
        {
            "pitch": {"uniform": [0.6, 1.38]},
            "direction": {"uniform": [-3.1415926535, 3.1415926535]},
            "horizontal_bias": {"mirrored": [2.5, 4.5]},
            "warm_up_steps": 1510,
        },
    )
    assert validated(RewardConfig, {"view_range": 1.0, "distance_scale": 0.05})
    assert validated(DoneConfig, {"min_height": 1.0, "velocity": 10000.0})
