import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from eyas.core.errors import OutputError
from eyas.exports.frames import frame_name, write_frame


def picture() -> np.ndarray:
    rgb = np.full((48, 64, 3), 90, np.uint8)
    rgb[20:24, 30:34] = (220, 30, 30)
    return rgb


def test_a_frame_reads_back_nearly_as_it_was(tmp_path):
    write_frame(tmp_path / "a.jpeg", picture())
    with Image.open(tmp_path / "a.jpeg") as image:
        assert image.format == "JPEG"
        shown = np.asarray(image).astype(int)
    # The small red target keeps its own colour, which needs 4:4:4.
    assert np.abs(shown - picture()).max() <= 6


def test_the_same_picture_gives_the_same_bytes(tmp_path):
    write_frame(tmp_path / "a.jpeg", picture())
    write_frame(tmp_path / "b.jpeg", picture())
    assert (tmp_path / "a.jpeg").read_bytes() == (tmp_path / "b.jpeg").read_bytes()


def test_frames_are_named_with_six_digits():
    assert [frame_name(0), frame_name(123), frame_name(1_234_567)] == [
        "000000",
        "000123",
        "1234567",
    ]


LIMITED = """
import resource, sys
from pathlib import Path
import numpy as np
from eyas.core.errors import OutputError
from eyas.exports.frames import write_frame
from eyas.exports.movie import MovieWriter
folder = Path(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
noise = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
def movie():
    writer = MovieWriter(folder / "a.mp4", 48, 64, 25.0)
    try:
        for _ in range(100):
            writer.add(noise)
        writer.finish()
    except OutputError:
        writer.abandon()
        raise
for write in (lambda: write_frame(folder / "a.jpeg", noise), movie):
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
        write_frame(tmp_path / "a.jpeg", picture())
    assert [path.name for path in tmp_path.iterdir()] == ["a.jpeg"]
