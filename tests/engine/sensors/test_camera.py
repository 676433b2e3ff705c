"""The camera: its view, its samples, and whom each picture is about."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.task.config import StartConfig

TRACKERS = np.arange(2, dtype=np.int32)


@pytest.fixture(scope="module")
def drawn():
    """Draw what two trackers of one world see, by cameras with some settings."""
    simulations = {}

    def draw(height, width, **camera):
        key = tuple(camera.items())
        if key not in simulations:
            config = SimConfig(
                camera=CameraConfig(width=96, height=72, **camera),
                start=StartConfig(pitch=1.2, height=22.0),
            )
            simulations[key] = build_simulation(config, together(2))
            simulations[key].reset()
        simulation = simulations[key]
        picture = Picture.create(2, height, width, depth=True, object_id=True, subject=True)
        simulation.draw(TRACKERS, picture)
        return simulation, picture

    return draw


@pytest.mark.parametrize(("down", "across"), [(1, 3), (3, 1)])
def test_a_picture_of_another_shape_squeezes_the_configured_view(drawn, down, across):
    _, whole = drawn(72, 96)
    _, squeezed = drawn(72 // down, 96 // across)
    # Every third pixel has its centre where one of the squeezed picture has its own.
    rows, columns = slice(down // 2, None, down), slice(across // 2, None, across)
    same = whole.object_id[:, rows, columns] == squeezed.object_id
    assert same.mean() > 0.97
    np.testing.assert_allclose(
        np.median(np.abs(whole.depth[:, rows, columns] - squeezed.depth)[same]), 0.0, atol=1e-3
    )


def test_a_wider_field_of_view_shows_the_target_smaller(drawn):
    narrow, wide = (
        drawn(72, 96, field_of_view=angle)[1].subject_pixels[:, 1].astype(float)
        for angle in (0.6, 1.0)
    )
    expected = (np.tan(0.5) / np.tan(0.3)) ** 2
    assert narrow / wide == pytest.approx(expected, rel=0.15)


def test_more_samples_come_nearer_to_a_finer_picture(drawn):
    _, fine = drawn(144, 192, pixel_filter="box")
    truth = fine.rgb.reshape(2, 72, 2, 96, 2, 3).mean(axis=(2, 4))
    coarse = [drawn(72, 96, samples=n, pixel_filter="box")[1].rgb for n in (1, 2, 4)]
    error = [np.abs(rgb - truth).mean() for rgb in coarse]
    assert error[1] < 0.9 * error[0]
    assert error[2] < 0.85 * error[1]


def test_each_picture_is_about_the_target_of_its_tracker(drawn):
    simulation, picture = drawn(72, 96)
    actors = simulation.snapshot.targets.actor
    assert actors[0] != actors[1]
    for n in TRACKERS:
        shown = picture.object_id[n] == ACTOR_OBJECT + actors[n]
        assert picture.subject_pixels[n, 0] == shown.sum() > 0
        rows, columns = np.nonzero(shown)
        left, top, right, bottom = picture.subject_box[n]
        assert left <= columns.min() <= columns.max() < right
        assert top <= rows.min() <= rows.max() < bottom
