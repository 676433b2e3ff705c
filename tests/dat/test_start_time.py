"""The first episode begins later with each channel and agent, as the original's does."""

import pytest

from eyas.dat.serve.run import _crew
from eyas.dat.settings.adapter import from_original
from eyas.engine.core.config import updated
from eyas.engine.video import run as video

OURS = {"camera": {"width": 32, "height": 24}, "start": {"warm_up_steps": 20}}
SHORT = {"channels": 2, "start_time": 0.05, "total_time": 0.05, "warm_up_steps": 0}
SHORT |= {"writers": ["jpeg", "labels"]}


def test_a_channel_is_four_steps(tmp_path):
    original = updated(from_original({}), {**OURS, "video": SHORT})
    native = original.model_copy(update={"original": None})
    later = updated(native, {"start": {"warm_up_steps": 28}})
    found = {}
    for name, config in (("original", original), ("later", later), ("native", native)):
        video.run(config, tmp_path / name, quiet=True)
        found[name] = {
            path.name: path.read_bytes() for path in (tmp_path / name).glob("DRONE0/episode0/*")
        }
    assert found["original"] == found["later"] != found["native"]


@pytest.mark.parametrize("count", [1, 2])
def test_an_agent_is_six_steps(count):
    group = _crew(updated(from_original({}), OURS), count)
    group.sim.reset()
    assert group.sim.snapshot.episodes.tick.tolist() == [20 + 6 * count] * count
    group.close()
