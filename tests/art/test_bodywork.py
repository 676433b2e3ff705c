import numpy as np
import pytest

from art.cars.regions import BASE, FRONT, RAISED, REAR, SIDE, STYLES, TOP
from eyas.engine.render.textures.mipmap import linear
from eyas.maps.textures.shipped import build_textures

TEXTURES = build_textures()


def bodywork(style):
    return TEXTURES[f"bodywork_{style}"]


def tones(style):
    """Brightness of a texture, linear, rows from below."""
    return linear(bodywork(style)[::-1, :, :3] / 255.0)


def cut(values, region):
    return values[region.bottom : region.top, region.left : region.right]


@pytest.mark.parametrize("style", STYLES)
def test_most_of_a_body_has_the_colour_that_words_name(style):
    values = tones(style)
    assert np.ptp(values, axis=2).max() == 0.0
    above = SIDE._replace(bottom=(SIDE.bottom + SIDE.top) // 2)  # clear of the dirt below
    for region in (above, TOP):
        shown = cut(values[..., 0], region) * linear(np.array(RAISED))
        assert np.median(shown) == pytest.approx(1.0, abs=0.06)
        assert shown.mean() > 0.75


@pytest.mark.parametrize("style", STYLES)
def test_seams_cross_sides_and_ends_without_gloss(style):
    texture = bodywork(style)[::-1]
    dark = tones(style)[..., 0] < 0.4 * BASE  # soft: the eye blends a gap of 5 mm with its edges
    for region in (SIDE, TOP, REAR, FRONT):
        assert 0.01 < cut(dark, region).mean() < 0.45
    assert np.quantile(texture[..., 3][dark], 0.8) < 105  # a sunroof is dark and glossy
    assert np.median(texture[..., 3]) == 255


def test_styles_differ():
    assert len({bodywork(style).tobytes() for style in STYLES}) == len(STYLES)
