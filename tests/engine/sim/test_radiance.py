"""Radiances, which camera models develop, against the bytes that the renderer makes of them."""

import dataclasses

import numpy as np
import pytest

from eyas.engine.camera.tone import ToneCurve
from eyas.engine.render.kernels.tent import filter_pixels
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.trackers.kinds import tracker_of

SIZE = 40, 60


@pytest.fixture(scope="module")
def simulation(config, assets) -> Simulation:
    small = config.model_copy(
        update={"camera": config.camera.model_copy(update={"height": SIZE[0], "width": SIZE[1]})}
    )
    made = Simulation(small, assets, tracker_of(small.tracker), each_alone(3))
    made.reset()
    return made


def _pictures(simulation: Simulation, samples: int, **wanted: bool) -> Picture:
    chosen = np.arange(simulation.count, dtype=np.int32)
    picture = Picture.create(simulation.count, *SIZE, **wanted)
    drawer = simulation.view.pictures
    drawer._samples = samples
    drawer.draw(chosen, picture, DrawStage.SHADING)
    return picture


def test_toned_radiances_are_the_bytes_of_the_picture(simulation, assets):
    both = _pictures(simulation, 1, radiance=True, depth=True)
    toned = np.empty_like(both.rgb)
    ToneCurve(assets.lighting.exposure).develop(both.radiance, toned)
    filter_pixels(toned)
    assert np.array_equal(toned, both.rgb)
    assert np.isfinite(both.radiance).all()
    assert (both.radiance >= 0.0).all()


def test_four_samples_are_added_up_as_light(simulation):
    """Their mean is that of a picture of twice the size, with one sample for each pixel."""
    fine = _pictures(simulation, 4, radiance=True).radiance
    coarse = _pictures(simulation, 1, radiance=True).radiance
    assert not np.array_equal(fine, coarse)
    assert fine.mean() == pytest.approx(coarse.mean(), rel=0.02)


def test_views_of_one_picture_draw_its_rows(simulation):
    """Three views of one camera that draw some rows each make the picture of one view."""
    whole = _pictures(simulation, 1, radiance=True, depth=True, object_id=True, subject=True)
    drawer, renderer = simulation.view.pictures, simulation._assets.renderer
    cameras = simulation.snapshot.cameras
    views, movers = drawer._views(np.arange(3, dtype=np.int32), cameras, SIZE[0] / SIZE[1])
    rows = np.array([(0, 7), (7, 22), (22, SIZE[0])], np.int32)
    thrice = np.repeat(np.arange(3, dtype=np.int32), 3)
    arrays = ("position", "rotation", "world", "subject", "field_of_view", "instant")
    parts = dataclasses.replace(
        views,
        **{name: getattr(views, name)[thrice] for name in arrays},
        picture=thrice,
        rows=np.tile(rows, (3, 1)),
    )
    made = Picture.create(3, *SIZE, radiance=True, depth=True, object_id=True, subject=True)
    renderer.draw(parts, movers, made)
    for field in dataclasses.fields(Picture):
        one, other = getattr(whole, field.name), getattr(made, field.name)
        assert (one is None) == (other is None)
        assert one is None or np.array_equal(one, other), field.name
