import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.core.errors import OutputError
from eyas.engine.core.files import write_atomic
from eyas.engine.exports.images import JpegWriter
from eyas.engine.exports.writer import Summary


def picture() -> np.ndarray:
    rgb = np.full((48, 64, 3), 90, np.uint8)
    rgb[20:24, 30:34] = (220, 30, 30)
    return rgb


def test_a_frame_reads_back_nearly_as_it_was(tmp_path):
    write_atomic(tmp_path / "a.jpeg", jpeg_bytes(picture()))
    with Image.open(tmp_path / "a.jpeg") as image:
        assert image.format == "JPEG"
        shown = np.asarray(image).astype(int)
    # The small red target keeps its own colour, which needs 4:4:4.
    assert np.abs(shown - picture()).max() <= 6


def test_the_same_picture_gives_the_same_bytes():
    assert jpeg_bytes(picture()) == jpeg_bytes(picture())


def test_pictures_are_named_with_six_digits_and_counted(run, episode, frame):
    writer = JpegWriter(run)
    part = writer.begin(episode)
    for number in range(3):
        part.add(frame(number))
    part.finish()
    names = sorted(path.name for path in episode.folder.iterdir())
    assert names == ["000000.jpeg", "000001.jpeg", "000002.jpeg"]
    (episode.folder / "best.jpeg").write_text("mine")
    assert writer.read(episode.folder) == Summary(3)
    (episode.folder / "000001.jpeg").unlink()
    assert writer.read(episode.folder) is None


def test_pictures_have_the_quality_of_the_run(run, episode, frame, tmp_path):
    noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    sizes = []
    for quality in (50, 95, 100):
        part = JpegWriter(replace(run, jpeg_quality=quality)).begin(episode)
        part.add(replace(frame(0), rgb=noise))
        sizes.append((episode.folder / "000000.jpeg").stat().st_size)
    assert sizes == sorted(set(sizes))


LIMITED = """
import resource, sys
from pathlib import Path
import numpy as np
from eyas.engine.core.errors import OutputError
from types import SimpleNamespace
from eyas.engine.core.files import write_atomic
from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.exports.mp4 import Mp4Episode
folder = Path(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
def movie():
    writer = Mp4Episode(folder / "a.mp4", 48, 64, 25.0)
    try:
        for _ in range(100):
            writer.add(SimpleNamespace(rgb=noise))
        writer.finish()
    except OutputError:
        writer.abandon()
        raise
for write in (lambda: write_atomic(folder / "a.jpeg", jpeg_bytes(noise)), movie):
    try:
        write()
    except OutputError as error:
        print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="file size limits are POSIX")
def test_a_file_that_does_not_fit_is_one_line_and_leaves_nothing(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(tmp_path)], capture_output=True, text=True, check=True
    )
    picture_line, movie_line = done.stdout.splitlines()
    assert picture_line.startswith(f"{tmp_path}/a.jpeg: cannot write: ")
    assert movie_line.startswith(f"{tmp_path}/a.mp4: cannot write: ")
    assert done.stderr == ""
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_way_is_one_line(tmp_path):
    os.mkdir(tmp_path / "a.jpeg")
    with pytest.raises(OutputError, match=r"a\.jpeg: cannot write"):
        write_atomic(tmp_path / "a.jpeg", jpeg_bytes(picture()))
    assert [path.name for path in tmp_path.iterdir()] == ["a.jpeg"]
