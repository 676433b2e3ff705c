"""Recording while SUMO drives."""

import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.task.config import DoneConfig
from eyas.engine.traffic.config import Lamps, Source, TrafficConfig
from eyas.engine.video import run as video

# Without pedestrians, who cross roads only where it is known in advance where vehicles will be, and
# without brake lamps: a recording has them from what a vehicle does next, SUMO from its driver.
DARK = TrafficConfig(lamps=Lamps.DARK)
RECORDED = EyasConfig(
    extras=(),
    traffic=DARK,
    camera=CameraConfig(width=48, height=36),
    done=DoneConfig(total_steps=400),
    video=VideoConfig(
        channels=2,
        fps=5.0,
        start_time=0.7,
        total_time=2.0,
        flight="exact",
        writers=("jpeg", "labels"),
    ),
)
LIVE = RECORDED.model_copy(update={"traffic": DARK.model_copy(update={"source": Source.LIVE})})


def files_of(config, folder) -> dict:
    video.run(config, folder, quiet=True)
    return {path.relative_to(folder): path.read_bytes() for path in folder.glob("DRONE*/*/*")}


@pytest.mark.slow
@pytest.mark.sumo
def test_live_traffic_gives_the_pictures_and_labels_of_its_recording(tmp_path):
    """Twice, as a live world must be closed when its recording ends."""
    pytest.importorskip("libsumo")
    expected = files_of(RECORDED, tmp_path / "recorded")
    assert len(expected) > 20
    assert files_of(LIVE, tmp_path / "live") == expected
    assert files_of(LIVE, tmp_path / "again") == expected
