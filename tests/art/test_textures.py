"""What ships of textures is what is painted."""

import numpy as np
import pytest

from art.textures.library import PAINTERS, painted_texture, painted_textures
from eyas.engine.world.build.materials import TEXTURES
from eyas.maps.textures.shipped import build_textures

FEW = ("asphalt", "brick", "leaves", "facade_glass", "panes")


def test_each_texture_of_the_materials_has_a_painter():
    assert PAINTERS.keys() == TEXTURES.keys()


@pytest.mark.parametrize("name", FEW)
def test_a_texture_is_what_its_painter_paints(name):
    assert np.array_equal(build_textures()[name], painted_texture(name))


@pytest.mark.slow
def test_all_textures_are_what_is_painted():
    shipped = build_textures()
    stale = [name for name, own in painted_textures().items() if (shipped[name] != own).any()]
    assert not stale, "run `python -m art.ship textures`"
