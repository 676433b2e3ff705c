"""Draw lists, cameras and pictures made on a device, against the usual ones: the same bytes."""

import re

import numpy as np
import pytest

from eyas.engine.sim.build import assets_of, build_simulation, in_one_wind
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.trackers.kinds import tracker_of
from eyas.gpu.ptx import ptx_of
from eyas.gpu.render.device_views import StagedDrawer
from eyas.gpu.sim.host_renderer import HostRenderer
from eyas.gpu.sim.signals import shown_part, signal_times
from eyas.gpu.sim.simulation import DeviceSimulation
from eyas.gpu.sim.view import DeviceView, empty_slots, list_actors
from eyas.lanes import interpreted
from eyas.lanes.device import HostDevice

from ...kit.walkers import FEW

SIZE = (30, 44)
SHORT = {"done": {"total_steps": 200, "grace_steps": 0, "no_reward_steps": 80}}
CASES = {
    "night": {"world": {"weather": "night"}},
    "snow": {
        "world": {"weather": "snow"},
        "camera": {"field_of_view": {"uniform": [0.6, 1.1]}},
        "light": {"background": {"uniform": [-0.2, 0.2]}},
    },
    "person": {"target": "Pedestrian", "objects": FEW},
    "robot": {"target": "BB-8", "objects": FEW},
}


class Kept:
    """One that keeps what it is given."""

    def draw(self, cameras, movers, rgb, subject):
        self.given = cameras, movers


def pair(case, count, workers, drawer=None):
    """A usual simulation, and one on a device with its view, both at the start."""
    config = SimConfig.model_validate(SHORT | CASES[case])
    assets, tracker = assets_of(config, each_alone(count)), tracker_of(in_one_wind(config))
    device = HostDevice(workers)
    ours = DeviceSimulation(config, assets, tracker, count, device, size=SIZE, steps=20)
    usual = build_simulation(config, each_alone(count))
    ours.reset(np.arange(count))
    usual.reset()
    return usual, ours, DeviceView(ours, drawer or HostRenderer(assets.renderer))


def steps(usual, ours, count):
    """Take steps in both, with resets, and yield some trackers after each."""
    rng, begun = np.random.default_rng(3), np.zeros(usual.count, np.bool_)
    for _ in range(count):
        commands = rng.normal(size=(usual.count, 4)) * (6.0, 6.0, 0.0, 1.5)
        usual.advance(commands, 20, ~begun)
        ours.device.write(ours.commands, commands)
        ours.advance(~begun)
        begun_anew = np.logical_or(*ours.ended())
        if begun.any():
            usual.reset(begun)
            ours.reset(np.flatnonzero(begun))
        begun = begun_anew
        chosen = np.flatnonzero(rng.random(usual.count) < 0.7)
        if len(chosen):
            yield chosen


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("count", "workers"), [(1, 1), (7, 3)])
def test_pictures_are_the_same(case, count, workers):
    usual, ours, view = pair(case, count, workers)
    picture, rgb = Picture.create(count, *SIZE), np.zeros((count, *SIZE, 3), np.uint8)
    for chosen in steps(usual, ours, 12):
        expected = picture.first(len(chosen))
        usual.draw(chosen, expected)
        view.draw(chosen, rgb)
        assert np.array_equal(rgb[: len(chosen)], expected.rgb)


def test_the_stages_of_devices_draw_the_same():
    usual, ours, view = pair("snow", 5, 2)
    view._drawer = StagedDrawer(HostDevice(1), *usual._assets.renderer.packed)
    picture, rgb = Picture.create(5, *SIZE), np.zeros((5, *SIZE, 3), np.uint8)
    for chosen in steps(usual, ours, 8):
        expected = picture.first(len(chosen))
        usual.draw(chosen, expected)
        view.draw(chosen, rgb)
        assert np.array_equal(rgb[: len(chosen)], expected.rgb)


@pytest.mark.parametrize("workers", [1, 64])
def test_lists_and_cameras_are_the_same(workers):
    kept = Kept()
    usual, ours, view = pair("night", 7, workers, kept)
    for chosen in steps(usual, ours, 15):
        view.draw(chosen, None)
        cameras, movers = kept.given
        views, listed = usual._present.pictures._own_views(chosen, seen(usual, chosen))
        assert cameras.views == min(1 << (len(chosen) - 1).bit_length(), 7)
        rows = slice(len(chosen))
        assert np.array_equal(cameras.eye[rows], views.position)
        assert np.array_equal(cameras.axes[rows].swapaxes(1, 2), views.rotation)
        assert np.array_equal(cameras.focal[rows], views.focal(*SIZE))
        assert np.array_equal(cameras.subject[rows], views.subject)
        assert np.array_equal(cameras.instant[rows], views.instant)
        for v in range(len(chosen)):
            shown, expected = movers.part[v] >= 0, listed.part[v] >= 0
            assert expected.sum() > 0
            # A device lists the lights of all signals, also those that no camera may show.
            still, theirs = movers.object_id[v] < ACTOR_OBJECT, listed.object_id[v][expected]
            shown &= ~still | np.isin(movers.object_id[v], theirs)
            for name in ("part", "pose", "colour", "object_id", "lamps"):
                own, usuals = getattr(movers, name)[v], getattr(listed, name)[v]
                assert own[shown].tobytes() == usuals[expected].tobytes(), name


def seen(simulation, chosen):
    cameras = simulation.snapshot.cameras
    return type(cameras)(*(array[chosen] for array in cameras))


def test_signals_show_what_their_plan_says():
    config = SimConfig()
    lights = assets_of(config, each_alone(1)).signals
    last = 630_000
    times = signal_times(lights, last)
    shown = interpreted(shown_part)
    ticks = np.append(np.random.default_rng(0).integers(0, last, 300), [0, last])
    near = times.tick[np.random.default_rng(1).integers(0, len(times.tick), 60)]
    ticks = np.concatenate([ticks, near, np.maximum(near - 1, 0)])
    aspects = lights.plan.at(ticks * 0.002)[:, lights.row]
    expected = np.where(aspects < 0, -1, lights.first_part + aspects)
    for row, tick in zip(expected, ticks.tolist(), strict=True):
        assert [shown(times, pole, tick) for pole in range(len(row))] == row.tolist()


def test_the_drivers_compile_for_cuda():
    _, _, view = pair("night", 2, 1)
    calls = [
        (list_actors, (*view._looking, *view._lists)),
        (empty_slots, (view._snapshot, view._looking[3], *view._lists, view._signals)),
        *((call, bundles) for call, _, bundles in view._casts[:2]),
    ]
    for call, bundles in calls:
        text = ptx_of(call, tuple(held.bundle for held in bundles), "kernel")
        assert "fma" not in text
        assert not re.search(r"\.extern \.func|vprintf", text)
        assert not re.search(r"\b(mad|mul|add|sub)\.(f32|f64)\b", text)
