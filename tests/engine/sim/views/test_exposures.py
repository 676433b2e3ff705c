"""Blur and rolling shutter, against accumulations of sharp pictures and against theory."""

import numpy as np
import pytest

from eyas.engine.camera.config import CameraConfig
from eyas.engine.camera.shutter import ShutterConfig
from eyas.engine.camera.vibration import VibrationConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.views.exposures import Moment, exposure_of
from eyas.engine.sim.worlds import each_alone, together
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.snapshot import CameraState
from eyas.engine.task.config import StartConfig

SIZE = 84
YAW = np.array([[0.0, 0.0, 0.0, 2.0]])
ASIDE = np.array([[0.0, 9.0, 0.0, 0.5]])
HOVER = np.zeros((1, 4))
ONE = np.zeros(1, np.int32)


def simulation_of(count=1, worlds=each_alone, vibration=0.0, **shutter):
    camera = CameraConfig(
        width=SIZE, height=SIZE, shutter=ShutterConfig(**shutter),
        vibration=VibrationConfig(angle=vibration),
    )  # fmt: skip
    start = StartConfig(height=8.0, pitch=0.6)
    simulation = build_simulation(SimConfig(camera=camera, start=start), worlds(count))
    simulation.reset()
    return simulation


def light_of(simulation, chosen=ONE):
    picture = Picture.create(len(chosen), SIZE, SIZE, rgb=False, radiance=True)
    simulation.view.pictures.draw(chosen, picture, DrawStage.SHADING)
    return picture.radiance


def sharp_light(simulation, cameras, later):
    """Draw one sharp picture some time later than now."""
    pictures = simulation.view.pictures
    views, movers = pictures.views_at(Moment(ONE, cameras, np.array([later])))
    picture = Picture.create(1, SIZE, SIZE, rgb=False, radiance=True)
    pictures.render(views, movers, picture, DrawStage.SHADING)
    return picture.radiance


def turned(cameras, later):
    """Return a camera after turning and moving on, by the matrix exponential's series."""
    x, y, z = cameras.angular_velocity[0] * later
    generator = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn, term = np.eye(3), np.eye(3)
    for k in range(1, 12):
        term = term @ generator / k
        turn = turn + term
    position = cameras.position + later * cameras.velocity
    return CameraState(position, (turn @ cameras.rotation[0])[None], cameras.field_of_view)


def accumulated(simulation, exposure, count=64):
    cameras = simulation.snapshot.cameras
    instants = exposure * ((np.arange(count) + 0.5) / count - 0.5)
    return np.mean([sharp_light(simulation, turned(cameras, at), at) for at in instants], axis=0)


def levels(light):
    """Radiance as levels of 255, by sRGB's curve."""
    share = np.clip(light, 0.0, 1.0)
    return 255 * np.where(share < 0.0031308, 12.92 * share, 1.055 * share ** (1 / 2.4) - 0.055)


def test_a_fast_yaw_blurs_as_an_accumulation_of_64_sharp_pictures():
    simulation = simulation_of(blur=True, exposure=0.03, most_samples=16)
    simulation.advance(YAW, 200)
    truth, sharp = accumulated(simulation, 0.03), accumulated(simulation, 0.0, 1)
    blurred = light_of(simulation)
    error, change = (np.abs(levels(a) - levels(truth)).mean() for a in (blurred, sharp))
    assert change > 3.0
    assert error < 0.25 * change
    assert np.abs(blurred.mean() - truth.mean()) < 0.01 * truth.mean()


def test_a_flight_blurs_as_the_mean_of_the_pictures_of_its_physics_steps():
    blurry = simulation_of(blur=True, exposure=0.042, most_samples=21)
    truth = simulation_of(blur=True, exposure=0.0)
    blurry.advance(YAW, 200)
    truth.advance(YAW, 189)
    seen = []
    for _ in range(21):
        truth.advance(YAW, 1)
        seen.append(light_of(truth))
    mean = np.mean(seen, axis=0)
    error = np.abs(levels(light_of(blurry)) - levels(mean)).mean()
    assert error < 0.25 * np.abs(levels(seen[10]) - levels(mean)).mean()


def test_a_passing_car_blurs_and_what_stands_still_does_not():
    simulation = simulation_of(blur=True, exposure=0.06, most_samples=16)
    for _ in range(60):  # the drone hovers, and the target leaves
        simulation.advance(HOVER, 10)
        target = simulation.snapshot.targets
        if target.speed[0] > 6.0:
            break
    truth, sharp = accumulated(simulation, 0.06), accumulated(simulation, 0.0, 1)
    blurred = light_of(simulation)
    moves = np.abs(levels(truth) - levels(sharp)).max(axis=(0, 1)) > 2.0
    assert 50 < moves.sum() < 0.5 * SIZE * SIZE
    error, change = (
        np.abs(levels(a) - levels(truth))[:, :, moves].mean() for a in (blurred, sharp)
    )
    assert error < 0.4 * change
    # Where the car's seams and panes pass by, few instants may catch one that many do not show.
    off = np.abs(levels(blurred) - levels(sharp)).max(axis=(0, 1))[~moves] > 2.1
    assert off.mean() < 0.003


def test_nothing_moves_and_nothing_is_blurred():
    blurry, sharp = simulation_of(blur=True, exposure=1e-6), simulation_of()
    for simulation in (blurry, sharp):
        simulation.advance(YAW, 100)
    first, second = Picture.create(1, SIZE, SIZE), Picture.create(1, SIZE, SIZE)
    blurry.draw(ONE, first)
    sharp.draw(ONE, second)
    np.testing.assert_array_equal(first.rgb, second.rgb)


def test_rows_are_exposed_one_after_the_other():
    """Each band of rows is that of the global picture of a camera at the band's instant."""
    readout = 0.03
    rolling = simulation_of(readout=readout)
    rolling.advance(ASIDE, 300)
    picture = Picture.create(1, SIZE, SIZE, depth=True, object_id=True)
    rolling.draw(ONE, picture)
    cameras = rolling.snapshot.cameras
    whole = Picture.create(1, SIZE, SIZE, depth=True, object_id=True)
    pictures = rolling.view.pictures
    off = []
    for row in range(SIZE):
        later = readout * ((row + 0.5) / SIZE - 0.5)
        views, movers = pictures.views_at(Moment(ONE, turned(cameras, later), np.array([later])))
        pictures.render(views, movers, whole, DrawStage.SHADING)
        same = whole.object_id[0, row] == picture.object_id[0, row]
        assert same.mean() > 0.85
        off.append(np.abs(whole.rgb[0, row].astype(int) - picture.rgb[0, row]).mean())
    pictures.render(*pictures.views_at(Moment(ONE, cameras, np.zeros(1))), whole, DrawStage.SHADING)
    unrolled = np.abs(whole.rgb[0].astype(int) - picture.rgb[0]).mean(axis=(1, 2))
    assert np.mean(off) < 0.3 * unrolled.mean()
    assert not unrolled[SIZE // 2 - 2 : SIZE // 2 + 2].any()


def test_boxes_hold_the_pixels_that_are_drawn():
    rolling = simulation_of(readout=0.04)
    rolling.advance(YAW * 0.3, 40)
    actors = rolling.actors
    picture = Picture.create(1, SIZE, SIZE, object_id=True, subject=True, actors=actors)
    rolling.draw(ONE, picture)
    target = 65536 + int(rolling.snapshot.targets.actor[0])
    rows, columns = np.nonzero(picture.object_id[0] == target)
    assert len(rows) > 10
    box = [columns.min(), rows.min(), columns.max() + 1, rows.max() + 1]
    np.testing.assert_array_equal(picture.subject_visible_box[0], box)
    np.testing.assert_array_equal(picture.subject_pixels[0, 0], len(rows))


@pytest.mark.parametrize("worlds", [each_alone, together])
def test_no_byte_depends_on_other_views(worlds):
    simulation = simulation_of(3, worlds, vibration=0.002, blur=True, exposure=0.02, readout=0.02)
    simulation.advance(np.array([[5.0, 0, 0, 1.0], [0, 0, 0, -2.0], [0, 0, 0, 0]]), 100)
    every = np.arange(3, dtype=np.int32)
    whole = Picture.create(3, SIZE, SIZE, depth=True)
    simulation.draw(every, whole)
    for n in range(3):
        one = Picture.create(1, SIZE, SIZE, depth=True)
        simulation.draw(every[n : n + 1], one)
        np.testing.assert_array_equal(one.rgb[0], whole.rgb[n])
        np.testing.assert_array_equal(one.depth[0], whole.depth[n])


def test_the_number_of_samples_follows_the_motion():
    simulation = simulation_of(3, blur=True, exposure=0.02, most_samples=64)
    simulation.advance(np.array([[0, 0, 0, 0.0], [0, 0, 0, 1.0], [0, 0, 0, 2.0]]), 200)
    drawer = simulation.view.pictures._exposures
    chosen = np.arange(3, dtype=np.int32)
    simulation.draw(chosen, Picture.create(3, SIZE, SIZE))  # before which no shutter is sampled
    exposure = exposure_of(chosen, simulation.view.state.steady, None)
    samples, bands = drawer._pieces(chosen, exposure, np.array([SIZE, 1.0, 1.0]), SIZE)
    np.testing.assert_array_equal(bands, 1)
    focal = 0.5 * SIZE / np.tan(0.5 * simulation.snapshot.cameras.field_of_view[0])
    assert samples[2] == pytest.approx(focal * 2.0 * 0.02, abs=2.5)
    assert samples[1] < samples[2]


def test_a_rolling_shutter_goes_through_a_bent_lens():
    """Each row of a fisheye's picture is that of the global picture at the row's instant."""
    readout, lens = 0.03, {"model": "fisheye"}
    camera = CameraConfig(
        width=SIZE,
        height=SIZE,
        field_of_view=1.8,
        lens=lens,
        shutter=ShutterConfig(readout=readout),
    )
    simulation = build_simulation(SimConfig(camera=camera), each_alone(1))
    simulation.reset()
    simulation.advance(YAW, 200)
    picture = Picture.create(1, SIZE, SIZE)
    simulation.draw(ONE, picture)
    cameras, pictures = simulation.snapshot.cameras, simulation.view.pictures
    whole, off = Picture.create(1, SIZE, SIZE), []
    for row in range(0, SIZE, 6):
        later = readout * ((row + 0.5) / SIZE - 0.5)
        views, movers = pictures.views_at(Moment(ONE, turned(cameras, later), np.array([later])))
        pictures.render(views, movers, whole, DrawStage.SHADING)
        off.append(np.abs(whole.rgb[0, row].astype(int) - picture.rgb[0, row]).mean())
    pictures.render(*pictures.views_at(Moment(ONE, cameras, np.zeros(1))), whole, DrawStage.SHADING)
    unrolled = np.abs(whole.rgb[0].astype(int) - picture.rgb[0]).mean(axis=(1, 2))[::6]
    assert np.mean(off) < 0.5 * unrolled.mean()
