from pathlib import Path

import av
import numpy as np
import pytest

from eyas.exports.movie import MovieWriter


def gradient(frame: int, height: int, width: int) -> np.ndarray:
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[..., 0] = np.linspace(0, 255, width, dtype=np.uint8)
    rgb[..., 1] = np.linspace(0, 255, height, dtype=np.uint8)[:, None]
    rgb[..., 2] = 20 * frame
    return rgb


def write(path: Path, height: int, width: int, fps: float, frames: int = 7) -> None:
    movie = MovieWriter(path, height, width, fps)
    for frame in range(frames):
        movie.add(gradient(frame, height, width))
    movie.finish()


@pytest.mark.parametrize(
    ("height", "width", "fps"), [(48, 64, 25.0), (9, 33, 29.97), (8, 8, 0.0004)]
)
def test_a_movie_holds_every_picture_at_the_asked_rate(tmp_path, height, width, fps):
    write(tmp_path / "a.mp4", height, width, fps)
    with av.open(str(tmp_path / "a.mp4")) as container:
        stream = container.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert float(stream.average_rate) == pytest.approx(max(fps, 1 / 1001), rel=1e-4)
    assert len(pictures) == 7
    for frame, picture in enumerate(pictures):
        shown = picture[:height, :width].astype(int)
        assert np.abs(shown - gradient(frame, height, width)).mean() < 12


def test_the_same_pictures_give_the_same_bytes(tmp_path):
    write(tmp_path / "a.mp4", 48, 64, 25.0)
    write(tmp_path / "b.mp4", 48, 64, 25.0)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_a_movie_appears_only_when_it_is_whole(tmp_path):
    movie = MovieWriter(tmp_path / "a.mp4", 48, 64, 25.0)
    movie.add(gradient(0, 48, 64))
    assert not (tmp_path / "a.mp4").exists()
    movie.abandon()
    assert list(tmp_path.iterdir()) == []
