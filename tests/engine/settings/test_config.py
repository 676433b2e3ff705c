import json
import subprocess
import sys

from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.sim.config import SimConfig

LOADED = """
import sys
import eyas.engine.settings.file
heavy = {"numba", "av", "PIL", "shapely", "scipy", "rich"} & sys.modules.keys()
upper = {name for name in sys.modules if name.startswith("eyas.engine.exports.")}
print(sorted(heavy | upper))
"""


def test_settings_bring_no_code_of_what_they_configure():
    """Sections of houses come in with the settings; what they configure does not."""
    done = subprocess.run(
        [sys.executable, "-c", LOADED], check=True, capture_output=True, text=True
    )
    assert done.stdout.strip() == "[]"


def test_all_settings_are_those_of_a_simulation_and_those_of_its_uses():
    config = updated(EyasConfig(), {"camera": {"width": 64}, "video": {"fps": 9}})
    assert isinstance(config, SimConfig)
    uses = EyasConfig.model_fields.keys() - SimConfig.model_fields.keys()
    sections = {"train", "wire", "mavlink"}
    assert uses == {"mode", "verbose", "env", "video", "own", "original"} | sections


def test_a_file_without_the_settings_of_a_later_version_has_their_defaults(tmp_path):
    config = EyasConfig(seed=4, video={"forward_speed": 7})
    values = json.loads(config.model_dump_json())
    del values["env"]
    path = tmp_path / "config.json"
    path.write_text(json.dumps(values))
    assert load_settings(path) == config
