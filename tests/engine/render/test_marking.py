"""Lines of paint are as bright in a small picture as in truth, wherever they lie in its pixels."""

import numpy as np
import pytest

from eyas.engine.render.kernels.surface.shade import painted_share
from eyas.engine.state.mesh import MARGIN
from eyas.lanes import kernel

from ...kit.small_city import DAY, GROUND, LINE, ROAD, floor, looking, scene_of, with_line

f4 = np.float32


@kernel
def share_of(across, scale, way_x, way_z, size):
    one, zero = f4(1.0), f4(0.0)
    slope = (f4(scale), zero, zero)
    return painted_share(across, slope, f4(scale), (way_x, zero, way_z), -way_z * one, size)


def share(away: float, width: float, pixel: float, tilt: float = 0.0) -> float:
    """Return the share of paint of a pixel whose middle is so far away from a line's middle [m]."""
    half = 0.5 * width
    way = -np.sin(tilt), -np.cos(tilt)
    return float(share_of(f4(32 + away / half), f4(1 / half), f4(way[0]), f4(way[1]), f4(pixel)))


def test_near_by_a_line_has_sharp_edges_and_none_shows_beyond_the_pixel():
    near = [share(x, 0.2, 0.001) for x in (0.0, 0.09, 0.11, 0.3)]
    assert near == pytest.approx([1.0, 1.0, 0.0, 0.0], abs=1e-3)
    assert share(0.1, 0.2, 0.02) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("pixel", [0.05, 0.2, 0.4, 0.55, 3.0])
def test_all_of_the_paint_and_no_more_is_seen_within_the_margins(pixel):
    reach = 0.1 + MARGIN
    at = np.linspace(-reach, reach, 4001)
    seen = np.mean([share(x, 0.2, pixel) for x in at]) * 2 * reach
    assert seen == pytest.approx(0.2, rel=0.01)
    assert share(reach, 0.2, pixel) == pytest.approx(0.0, abs=0.01)


def test_a_pixel_is_longer_along_the_view():
    assert share(0.0, 0.2, 0.2, tilt=1.0) == pytest.approx(np.cos(1.0), abs=0.01)


def test_a_line_narrower_than_a_pixel_is_as_bright_wherever_it_lies_in_it(drawn, renderer_of):
    bare = scene_of([floor(60.0, "asphalt_paint")], [GROUND], size=120.0)
    with_paint, without = (renderer_of(s, lighting=DAY) for s in (with_line(bare), bare))
    excess, labelled = [], []
    for shift in np.linspace(0.0, 0.33, 8):  # a pixel spans 0.33 m
        views = looking([(0.0, float(shift), 33.6)], pitch=np.pi / 2, fov=0.7854)
        picture, ground = (drawn(r, views, size=(84, 84)) for r in (with_paint, without))
        excess.append((picture.rgb.astype(float) - ground.rgb).sum())
        labelled.append((picture.object_id == LINE).sum())
        assert (picture.object_id == ROAD).any()
    # Bytes are no light: two grey pixels add up to more than a white one and a black one.
    # Nor is asphalt: what the line hides differs from place to place.
    assert np.ptp(excess) < 0.3 * np.mean(excess)
    assert np.ptp(labelled) > 0.5 * np.mean(labelled)  # where only middles of pixels count
