"""Surface normals of pictures, against depth and the shapes that are drawn."""

import numpy as np
import pytest

from eyas.engine.core.optics.pinhole import rays
from eyas.engine.render import jobs
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT

WIDTH, HEIGHT, COUNT = 160, 120, 4


@pytest.fixture(scope="module")
def simulation():
    start = {"height": {"uniform": [4.0, 12.0]}, "pitch": {"uniform": [0.1, 0.7]}}
    config = EyasConfig(start=start, camera={"width": WIDTH, "height": HEIGHT})
    made = build_simulation(config, each_alone(COUNT))
    made.reset()
    made.carry(100)
    return made


def drawn(simulation, **wanted) -> Picture:
    picture = Picture.create(COUNT, HEIGHT, WIDTH, normal=True, **wanted)
    simulation.draw(np.arange(COUNT, dtype=np.int32), picture)
    return picture


def test_they_are_those_of_the_surface_that_depth_shows(simulation):
    picture = drawn(simulation, rgb=False, depth=True, object_id=True)
    compared = 0
    for n in range(COUNT):
        ahead = picture.depth[n]
        field = float(simulation.snapshot.cameras.field_of_view[n])
        # Right, down, ahead of the camera.
        local = rays(np.eye(3), WIDTH, HEIGHT, field)[..., [1, 2, 0]] * [-1.0, -1.0, 1.0]
        points = local * ahead[..., None]
        across, down = points[1:-1, 2:] - points[1:-1, :-2], points[2:, 1:-1] - points[:-2, 1:-1]
        with np.errstate(invalid="ignore"):
            expected = np.cross(down, across)
            expected /= np.linalg.norm(expected, axis=2, keepdims=True)
        told = picture.normal[n, 1:-1, 1:-1] / 127.5 - 1.0
        shown = picture.object_id[n]
        # Inside of one still object, whose surface is flat nearly everywhere.
        inside = shown[1:-1, 1:-1] < ACTOR_OBJECT
        for line, column in ((0, 1), (2, 1), (1, 0), (1, 2)):
            rows, columns = slice(line, line + HEIGHT - 2), slice(column, column + WIDTH - 2)
            inside &= shown[rows, columns] == shown[1:-1, 1:-1]
        inside &= np.isfinite(ahead[1:-1, 1:-1]) & np.isfinite(expected).all(axis=2)
        cosine = (told * expected).sum(axis=2)[inside]
        assert np.median(cosine) > 0.99
        compared += len(cosine)
    assert compared > 10_000


def test_they_have_length_1_face_the_camera_and_are_0_in_the_sky(simulation):
    picture = drawn(simulation, rgb=False, depth=True)
    told = picture.normal / 127.5 - 1.0
    sky = np.isinf(picture.depth)
    assert sky.any()
    assert not picture.normal[sky].any()
    length = np.linalg.norm(told[~sky], axis=1)
    assert np.abs(length - 1.0).max() < 0.02
    for n in range(COUNT):
        field = float(simulation.snapshot.cameras.field_of_view[n])
        local = rays(np.eye(3), WIDTH, HEIGHT, field)[..., [1, 2, 0]] * [-1.0, -1.0, 1.0]
        assert ((told[n] * local).sum(axis=2)[~sky[n]] < 0.02).all()


def test_neither_other_outputs_nor_bands_change_them(simulation, monkeypatch):
    alone, both = drawn(simulation, rgb=False), drawn(simulation, depth=True, subject=True)
    np.testing.assert_array_equal(alone.normal, both.normal)
    without = Picture.create(COUNT, HEIGHT, WIDTH)
    simulation.draw(np.arange(COUNT, dtype=np.int32), without)
    np.testing.assert_array_equal(without.rgb, both.rgb)
    monkeypatch.setattr(jobs, "SMALLEST_BAND", 500)
    monkeypatch.setattr(jobs, "JOBS_PER_THREAD", 12)
    simulation._present.pictures._renderer._tasks.clear()  # which keep their bands
    np.testing.assert_array_equal(drawn(simulation, rgb=False).normal, alone.normal)
