import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from eyas.engine.core.errors import OutputError
from eyas.engine.exports import webp
from eyas.engine.exports.webp import WebpEpisode, WebpWriter
from eyas.engine.exports.writer import Summary


def gradient(frame: int, height: int, width: int) -> np.ndarray:
    rgb = np.zeros((height, width, 3), np.uint8)
    rgb[..., 0] = np.linspace(0, 255, width, dtype=np.uint8)
    rgb[..., 1] = np.linspace(0, 255, height, dtype=np.uint8)[:, None]
    rgb[..., 2] = 20 * frame
    return rgb


def write(path: Path, height: int, width: int, fps: float) -> None:
    """Write a film of seven pictures."""
    film = WebpEpisode(path, height, width, fps)
    for number in range(7):
        film.add_picture(gradient(number, height, width))
    film.finish()


@pytest.mark.parametrize(
    ("height", "width", "fps"), [(48, 64, 25.0), (9, 33, 29.97), (8, 8, 0.0004)]
)
def test_a_film_holds_every_picture_at_the_asked_rate(tmp_path, height, width, fps):
    write(tmp_path / "a.webp", height, width, fps)
    shown = 0
    with Image.open(tmp_path / "a.webp") as film:
        assert (film.n_frames, film.size, film.info["loop"]) == (7, (width, height), 0)
        for number in range(7):
            film.seek(number)
            picture = np.asarray(film.convert("RGB")).astype(int)
            assert np.abs(picture - gradient(number, height, width)).mean() < 12
            shown += film.info["duration"]
    assert shown == min(round(7000 / fps), 7 * 0xFF_FFFF)


def test_the_same_pictures_give_the_same_bytes(tmp_path):
    write(tmp_path / "a.webp", 48, 64, 25.0)
    write(tmp_path / "b.webp", 48, 64, 25.0)
    assert (tmp_path / "a.webp").read_bytes() == (tmp_path / "b.webp").read_bytes()


def test_a_film_tells_how_many_pictures_it_has_if_it_is_whole(run, episode, frame):
    writer = WebpWriter(run)
    part = writer.begin(episode)
    part.add(frame(0))
    assert writer.read(episode.folder) is None
    part.add(frame(1))
    part.finish()
    assert writer.read(episode.folder) == Summary(2)
    film = episode.folder / "episode.webp"
    whole = film.read_bytes()
    for damaged in (b"", b"cut off", whole[:-1], whole[:25], whole + b"\0"):
        film.write_bytes(damaged)
        assert writer.read(episode.folder) is None


def test_pictures_are_on_the_disk_before_the_film_ends(run, episode, frame):
    """None of them is kept in memory."""
    part = WebpWriter(run).begin(episode)
    noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), np.uint8)
    for number in range(20):
        part.add(frame(number, rgb=noise))
    written = (episode.folder / ".episode.webp.part").stat().st_size
    assert written > 19 * len(encoded(noise)) - io.DEFAULT_BUFFER_SIZE
    part.abandon()


def encoded(rgb: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray(rgb).save(file, "WEBP", quality=75, method=0)
    return file.getvalue()


def test_an_abandoned_film_leaves_nothing(run, episode, frame):
    part = WebpWriter(run).begin(episode)
    part.add(frame(0))
    assert not (episode.folder / "episode.webp").exists()
    part.abandon()
    assert list(episode.folder.iterdir()) == []


def test_a_film_that_no_webp_can_hold_is_refused_in_one_line(tmp_path, monkeypatch):
    film = WebpEpisode(tmp_path / "a.webp", 48, 64, 25.0)
    film.add_picture(gradient(0, 48, 64))
    monkeypatch.setattr(webp, "_LARGEST", 300)
    with pytest.raises(OutputError, match=r"a\.webp: cannot write: .* 4 GiB; record shorter"):
        film.add_picture(gradient(1, 48, 64))
    film.abandon()
    assert list(tmp_path.iterdir()) == []
