"""The step on a device, which here is this processor, against the usual one: the same bytes."""

import dataclasses
import re
from functools import partial

import numpy as np
import pytest

from eyas.engine.core.errors import ConfigError
from eyas.engine.sim.build import assets_of, build_simulation, in_one_wind
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.targets.catalogue import kind_index
from eyas.engine.targets.rig import Rigs
from eyas.engine.trackers.kinds import tracker_of
from eyas.engine.trackers.wind_field import WindField
from eyas.gpu.ptx import ptx_of
from eyas.gpu.sim.simulation import DeviceSimulation, check_device
from eyas.lanes.device import HostDevice

SHORT = {"done": {"total_steps": 120, "grace_steps": 0, "no_reward_steps": 60}}
VARIED = {
    "camera": {"field_of_view": {"uniform": [0.6, 1.1]}, "mount": {"x": 0.2, "pitch": 0.9}},
    "light": {"background": {"uniform": [-0.2, 0.2]}},
    "world": {"wind": {"speed": 3.0}},
    "start": {"velocity": "target"},
}
WINDY = {
    "supervised": False,
    "drag_area": 0.02,
    "wind": {"speed": {"uniform": [1.0, 4.0]}, "turbulence": 3.0},
}
_SIDES = np.random.default_rng(3).integers(-900, 900, (16, 3, 8, 8, 3)).astype(np.int16)
AMONG = WindField(_SIDES, -30.0, -30.0, 10.0, 1)
EQUIPPED = {
    "wind": WINDY["wind"] | {"buildings": True},
    "off_centre": True,
    "ground_effect": True,
    "payload": {"mass": 0.4},
    "battery": {"enabled": True, "charge": 0.5},
}
CASES = {
    "drone": {},
    "flown": {"tracker": {"supervised": False}},
    "car": {"tracker": {"kind": "car"}},
    "varied": VARIED,
    "windy": {"tracker": WINDY},
    "equipped": {"tracker": WINDY | EQUIPPED},
}


def kind_of(config):
    """The tracker of a simulation, in a small field of wind."""
    kind = tracker_of(in_one_wind(config))
    if config.tracker.wind.buildings:
        return dataclasses.replace(kind, memory=partial(kind.memory, field=AMONG))
    return kind


def on_device(config, count, workers) -> DeviceSimulation:
    assets, tracker = assets_of(config, each_alone(count)), kind_of(config)
    size = (84, 84)
    return DeviceSimulation(config, assets, tracker, count, HostDevice(workers), size=size, steps=4)


def arrays(snapshot):
    return {name: a for record in snapshot for name, a in record._asdict().items()}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("count", "workers"), [(1, 1), (7, 3), (64, 64)])
def test_the_state_has_the_same_bytes_step_by_step_and_after_resets(case, count, workers):
    config = SimConfig.model_validate(SHORT | CASES[case])
    ours = on_device(config, count, workers)
    usual = build_simulation(config, each_alone(count), tracker=kind_of(config))
    ours.reset(np.arange(count))
    usual.reset()
    rng, begun, ends = np.random.default_rng(count), np.zeros(count, np.bool_), 0
    for _ in range(60):
        commands = rng.normal(size=(count, 4)) * (6.0, 6.0, 0.01, 1.5)
        result = usual.advance(commands, 4, ~begun)
        ours.device.write(ours.commands, commands)
        ours.advance(~begun)
        expected = arrays(usual.snapshot)
        for name, array in arrays(ours.snapshot).items():
            assert array.tobytes() == expected[name].tobytes(), name
        assert np.array_equal(ours.flown.reward, np.where(begun, 0.0, result.reward))
        begun_anew = np.logical_or(*ours.ended())
        assert np.array_equal(begun_anew, result.done & ~begun)
        ends += begun_anew.sum()
        begun = begun_anew
        if begun.any():
            usual.reset(begun)
            ours.reset(np.flatnonzero(begun))
    assert ends > 0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"control": {"action_latency_steps": 5}}, "control.action_latency_steps: 5"),
        ({"sensors": {"camera": {"noise": 0.1}}}, "sensors.camera"),
        ({"sensors": {"further": ["compass"]}}, "sensors.further: a sensor"),
        ({"camera": {"defocus": 0.01}}, "camera.defocus"),
        ({"lidar": {"enabled": True}}, "lidar.enabled: true"),
        ({"done": {"crash": "end"}}, "done.crash: 'end'"),
        ({"reward": {"terms": {"speed": 1.0}}}, "reward.terms: 'speed'"),
    ],
)
def test_what_is_not_there_is_told_in_one_line(changes, said):
    with pytest.raises(ConfigError) as told:
        on_device(SimConfig.model_validate(changes), 1, 1)
    assert str(told.value).startswith(said)
    assert "is not there on a device; allowed: " in str(told.value)
    assert "\n" not in str(told.value)


def test_trackers_that_do_not_tell_what_is_sampled_are_refused():
    config = SimConfig.model_validate({"tracker": WINDY})
    assets, tracker = assets_of(config, each_alone(1)), tracker_of(config.tracker)
    check_device(config, assets, tracker)
    with pytest.raises(ConfigError, match=r"tracker\.kind: a 'flown drone' with a sample is not"):
        check_device(config, assets, dataclasses.replace(tracker, sampled=None))


def test_kinds_that_python_poses_are_refused():
    config = SimConfig()
    assets = assets_of(config, each_alone(1))
    birds = dataclasses.replace(assets, rigs=Rigs(np.array([kind_index("bird")])))
    with pytest.raises(ConfigError, match="custom or airborne: a 'bird' is not there on a device"):
        check_device(config, birds, tracker_of(config.tracker))


def checked(call, bundles) -> None:
    """Check that a graphics processor can run it, to the bytes of the processor."""
    text = ptx_of(call, tuple(held.bundle for held in bundles), "kernel")
    assert "fma" not in text
    assert not re.search(r"\.extern \.func|vprintf", text)
    assert not re.search(r"\b(mad|mul|add|sub)\.(f32|f64)\b", text)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["drone", pytest.param("flown", marks=pytest.mark.slow)])
def test_the_drivers_compile_for_cuda(case):
    ours = on_device(SimConfig.model_validate(CASES[case]), 2, 1)
    checked(ours._calls.act, ours._act)
    checked(ours._calls.begin, ours._begin)
