"""`eyas targets`."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from eyas.cli.targets.listing import entries
from eyas.cli.targets.show import run
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.targets.catalogue import MODELS

BUILT_IN = [model.name for model in MODELS if model.name not in ("Bird", "Quadrotor")]
"""Read before any test adds a model of its own."""


def test_the_list_has_every_model_with_fewer_triangles_from_afar():
    lines = entries()[: len(BUILT_IN)]
    assert [line.name for line in lines] == BUILT_IN
    for line in lines:
        near, far = line.triangles
        assert 0 < far < near
        assert line.colours
    pedestrian = next(line for line in lines if line.name == "Pedestrian")
    assert pedestrian.size == (0.4, 0.6, 1.8)
    assert pedestrian.colours[0] == "green"
    assert pedestrian.motion == "walks from point to point, 2 m/s"


def test_unknown_names_and_endings_are_refused_before_anything_is_drawn(tmp_path):
    with pytest.raises(UnknownNameError, match="did you mean 'Sojourner'"):
        run("sojourner", tmp_path / "x.png")
    with pytest.raises(ConfigError, match=r"allowed endings: \.png, \.gif"):
        run("Create", tmp_path / "x.jpg")
    with pytest.raises(ConfigError, match=r"allowed endings: \.png$"):
        run("all", tmp_path / "x.gif")
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_a_sheet_and_a_film_show_the_target_in_its_colour(tmp_path):
    run("Shrimp", tmp_path / "sheet.png")
    sheet = np.asarray(Image.open(tmp_path / "sheet.png")).astype(int)
    blue = (sheet[..., 2] > 1.4 * sheet[..., 0]) & (sheet[..., 2] > 150) & (sheet[..., 1] > 80)
    middles = blue[64:320].reshape(256, 8, 256)[64:192, :, 64:192]
    assert (middles.sum(axis=(0, 2)) > 300).all()  # in each of the pictures all round
    run("Shrimp", tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as film:
        assert film.n_frames == 72


@pytest.mark.slow
def test_a_target_of_ones_own_is_shown_in_its_colours(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "examples")
    run("own_target:Sprinkler", tmp_path / "sheet.png")
    sheet = np.asarray(Image.open(tmp_path / "sheet.png")).astype(int)
    red, green, blue = sheet[64:320].reshape(256, 8, 256, 3)[64:192, :, 64:192].T
    box, arm = green > 1.4 * np.maximum(red, blue), (blue < 0.35 * red) & (green > 0.65 * red)
    for colour in (box, arm):
        assert (colour.sum(axis=(0, 2)) > 50).all()  # in each picture all round


@pytest.mark.slow
def test_a_sheet_shows_vehicles_whole(tmp_path):
    """With a margin of their ground all round: the tails of cars were cut off."""
    run("BmwX5Simple", tmp_path / "car.png")
    sheet = np.asarray(Image.open(tmp_path / "car.png").convert("RGB")).astype(int)
    row = sheet[40 + 24 : 40 + 24 + 256]
    for turn in range(8):
        picture = row[:, 256 * turn : 256 * (turn + 1)]
        red = (picture[..., 0] > 60) & (picture[..., 0] > 2 * picture[..., 1])
        columns = np.flatnonzero(red.sum(axis=0) > 2)
        assert columns[0] > 8, turn
        assert columns[-1] < 247, turn
