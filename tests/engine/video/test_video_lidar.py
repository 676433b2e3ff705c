"""`Lidar_Enable` of the original's file in `eyas video`."""

import json

from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.video.formats import with_writers
from eyas.engine.video.run import run


def test_the_original_s_switch_writes_the_lidar_s_file(tmp_path):
    values = {
        "Tracker_Def": "DRONE",
        "Lidar_Enable": True,
        "World_Path": "worlds/simpleway-grass_day.wbt",
        "Out_Video": {"channels": 1, "fps": 50, "start_time": 0, "total_time": 0.8},
    }
    (tmp_path / "env_config.json").write_text(json.dumps(values))
    small = ["camera.width=32", "camera.height=24", "video.warm_up_steps=5"]
    config = load_settings(tmp_path / "env_config.json", small)
    run(config, tmp_path / "out", quiet=True)
    lines = (tmp_path / "out/DRONE0/episode0/lidar.csv").read_text().splitlines()
    assert lines[0].startswith("frame,step,point_0,")
    assert len(lines) > 5


def test_writers_that_were_chosen_stay():
    chosen = {"video": {"writers": ("jpeg",)}, "lidar": {"enabled": True}}
    config = EyasConfig.model_validate(chosen)
    assert with_writers(config, quiet=True) is config
    off = EyasConfig()
    assert with_writers(off, quiet=True) == off
