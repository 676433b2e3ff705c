"""Procedural textures: all there, always the same, without seams, of the right colours."""

import hashlib

import numpy as np
import pytest

from eyas.engine.core.errors import DataFileError
from eyas.engine.render.textures.fields import fractal, source
from eyas.engine.render.textures.mipmap import linear
from eyas.engine.world.build.materials import FACADES, GROUND_FLOORS, TEXTURES
from eyas.maps.textures import shipped
from eyas.maps.textures.shipped import build_textures


@pytest.fixture(scope="module")
def textures():
    return build_textures()


def test_every_name_has_a_texture_of_the_right_kind(textures):
    assert textures.keys() == TEXTURES.keys()
    for image in textures.values():
        assert image.shape == (256, 256, 4)
        assert image.dtype == np.uint8


def test_a_damaged_file_is_told_in_a_line(tmp_path, monkeypatch):
    content = bytearray(shipped.FILE.read_bytes())
    content[len(content) // 2] ^= 1
    monkeypatch.setattr(shipped, "FILE", tmp_path / "textures.xz")
    for damaged in (bytes(content), content[:1000], b""):
        shipped.FILE.write_bytes(damaged)
        with pytest.raises(DataFileError, match="install Eyas again"):
            build_textures()


def test_no_two_textures_are_alike(textures):
    assert len({hashlib.sha256(image.tobytes()).digest() for image in textures.values()}) == len(
        textures
    )


@pytest.mark.parametrize("name", sorted(set(TEXTURES) - {"plain"}))
@pytest.mark.parametrize("axis", [0, 1])
def test_there_is_no_seam(textures, name, axis):
    # The step across the edge is no larger than steps at places like it inside: all lines that
    # are whole bays, slabs or bricks from the edge.
    image = textures[name][..., :3].astype(float)
    steps = np.abs(np.roll(image, -1, axis) - image).mean(axis=(1 - axis, 2))
    like_it = steps[15::16]
    assert steps[-1] <= max(1.6 * np.median(steps), 1.35 * like_it[:-1].max())


def test_noise_repeats_at_its_edges():
    field = fractal(source("test"), 2.0)
    across = np.abs(field[0] - field[-1]).mean()
    inside = np.abs(np.diff(field, axis=0)).mean()
    assert across < 2 * inside


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("asphalt", 0.12, 0.2),
        ("asphalt_patch", 0.05, 0.12),
        ("lawn", 0.05, 0.12),
        ("sand", 0.3, 0.4),
    ],
)
def test_ground_reflects_as_much_light_as_it_does_where_it_was_measured(
    textures, name, least, most
):
    reflected = linear(textures[name][..., :3] / 255.0).mean(axis=(0, 1))
    assert least < np.dot(reflected, (0.2126, 0.7152, 0.0722)) < most
    if name.startswith("asphalt"):
        assert np.ptp(reflected) < 0.015


@pytest.mark.parametrize("name", ["lawn", "asphalt", "soil", "concrete"])
def test_ground_is_lively_near_by_and_even_from_far(textures, name):
    grey = textures[name][..., :3].mean(axis=2)
    coarse = grey.reshape(8, 32, 8, 32).mean(axis=(1, 3))
    assert grey.std() > 4
    assert coarse.std() < 0.35 * grey.std()


@pytest.mark.parametrize("name", FACADES + GROUND_FLOORS)
def test_fronts_have_a_window_in_every_bay_of_every_storey(textures, name):
    glass = textures[name][..., 3] == 0
    share = glass.reshape(4, 64, 4, 64).mean(axis=(1, 3))
    assert set(np.unique(textures[name][..., 3])) == {0, 255}
    if name != "facade_plaster":  # some shutters are closed, but there is a pane behind
        assert share.min() > 0.08
    assert share.max() < 0.97


def test_row_0_is_the_top_of_the_tile(textures):
    # Ledges throw their shadow downwards: below the band at the head of a storey.
    grey = textures["facade_red_white"][..., :3].mean(axis=(1, 2))
    band, below = grey[1:6].mean(), grey[7:9].mean()
    assert below < 0.85 * band
    doors = textures["ground_lobby"][:64, 64:128, 3] == 0
    assert doors[55:61].mean() > 0.3
    assert doors[:7].mean() == 0


def test_leaves_stand_in_four_clusters_that_touch_no_edge(textures):
    alpha = textures["leaves"][..., 3]
    assert 0.35 < (alpha == 255).mean() < 0.7
    for edge in (0, 127, 128, 255):
        assert (alpha[edge] == 0).all()
        assert (alpha[:, edge] == 0).all()
    for y in (32, 160):
        for x in (32, 160):
            assert (alpha[y : y + 64, x : x + 64] > 0).mean() > 0.7


def test_leaves_are_green_with_a_few_orange_specks(textures):
    image = textures["leaves"].astype(float)
    leaf = image[image[..., 3] == 255][:, :3]
    red, green, blue = leaf.T
    assert (green > blue).mean() > 0.95
    assert green.mean() > red.mean()
    assert 0.002 < (red > 1.25 * green).mean() < 0.08
