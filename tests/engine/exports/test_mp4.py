from pathlib import Path

import av
import numpy as np
import pytest

from eyas.engine.exports.mp4 import Mp4Episode, Mp4Writer
from eyas.engine.exports.writer import Summary


def gradient(frame: int, height: int, width: int) -> np.ndarray:
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[..., 0] = np.linspace(0, 255, width, dtype=np.uint8)
    rgb[..., 1] = np.linspace(0, 255, height, dtype=np.uint8)[:, None]
    rgb[..., 2] = 20 * frame
    return rgb


@pytest.fixture
def write(frame):
    """Writes a movie of seven pictures."""

    def written(path: Path, height: int, width: int, fps: float) -> None:
        movie = Mp4Episode(path, height, width, fps)
        for number in range(7):
            movie.add(frame(number, rgb=gradient(number, height, width)))
        movie.finish()

    return written


@pytest.mark.parametrize(
    ("height", "width", "fps"), [(48, 64, 25.0), (9, 33, 29.97), (8, 8, 0.0004)]
)
def test_a_movie_holds_every_picture_at_the_asked_rate(tmp_path, write, height, width, fps):
    write(tmp_path / "a.mp4", height, width, fps)
    with av.open(str(tmp_path / "a.mp4")) as container:
        stream = container.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert float(stream.average_rate) == pytest.approx(max(fps, 1 / 1001), rel=1e-4)
    assert len(pictures) == 7
    for frame, picture in enumerate(pictures):
        shown = picture[:height, :width].astype(int)
        assert np.abs(shown - gradient(frame, height, width)).mean() < 12


def test_the_same_pictures_give_the_same_bytes(tmp_path, write):
    write(tmp_path / "a.mp4", 48, 64, 25.0)
    write(tmp_path / "b.mp4", 48, 64, 25.0)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_a_movie_tells_how_many_pictures_it_has(run, episode, frame):
    writer = Mp4Writer(run)
    part = writer.begin(episode)
    part.add(frame(0))
    assert writer.read(episode.folder) is None
    part.add(frame(1))
    part.finish()
    assert writer.read(episode.folder) == Summary(2)
    (episode.folder / "episode.mp4").write_bytes(b"cut off")
    assert writer.read(episode.folder) is None


def test_an_abandoned_movie_leaves_nothing(run, episode, frame):
    part = Mp4Writer(run).begin(episode)
    part.add(frame(0))
    assert not (episode.folder / "episode.mp4").exists()
    part.abandon()
    assert list(episode.folder.iterdir()) == []


def test_a_playlist_under_the_name_of_a_movie_is_not_played(run, episode, frame):
    part = Mp4Writer(run).begin(episode)
    part.add(frame(0))
    part.finish()
    movie = episode.folder / "episode.mp4"
    movie.rename(episode.folder / "other.mp4")
    movie.write_text("ffconcat version 1.0\nfile other.mp4\n")
    assert Mp4Writer(run).read(episode.folder) is None
