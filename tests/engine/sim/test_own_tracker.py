"""The example of a tracker of one's own, an aeroplane, named in the settings."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.dat.settings.adapter import to_original
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.trackers.config import TrackerConfig

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def aeroplanes(config, monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    own = config.model_copy(update={"tracker": TrackerConfig(kind="own_tracker:Aeroplane")})
    simulation = build_simulation(own, each_alone(2))
    simulation.reset()
    yield simulation
    sys.modules.pop("own_tracker", None)


def test_it_cannot_hover_and_turns_by_banking(aeroplanes):
    trackers = aeroplanes.snapshot.trackers
    yaw, place = trackers.euler[:, 2].copy(), trackers.position.copy()
    aeroplanes.advance(np.array([[0.0, 0.0, 0.0, 0.0], [20.0, 0.0, 0.0, 0.3]]), 1500)
    speed = np.linalg.norm(trackers.velocity, axis=1)
    assert speed == pytest.approx([12.0 + 4.0 * math.exp(-2.0), 20.0 - 4.0 * math.exp(-2.0)], 1e-2)
    assert np.linalg.norm(trackers.position - place, axis=1).min() > 20.0
    assert trackers.euler[0, 0] == 0.0
    assert trackers.euler[0, 2] == pytest.approx(yaw[0])
    assert trackers.euler[1, 0] == pytest.approx(-math.atan(0.3 * speed[1] / 9.81), abs=1e-2)
    assert (trackers.euler[1, 2] - yaw[1]) % (2 * math.pi) == pytest.approx(0.3 * 3.0, abs=0.1)


def test_its_camera_banks_with_it_and_its_sensors_feel_the_turn(aeroplanes):
    aeroplanes.advance(np.tile([16.0, 0.0, 0.0, 0.3], (2, 1)), 1500)
    bank = aeroplanes.snapshot.trackers.euler[0, 0]
    left = aeroplanes.snapshot.cameras.rotation[0, :, 1]
    assert left[2] == pytest.approx(math.sin(bank))
    felt = aeroplanes.packets()[0][0, 7:10]
    # A coordinated turn presses into the seat, and hardly to a side.
    assert felt == pytest.approx([0.0, 0.0, 9.81 / math.cos(bank)], abs=0.1)
    picture = Picture.create(2, 48, 64)
    aeroplanes.draw(np.arange(2, dtype=np.int32), picture)
    assert picture.rgb.std() > 5.0


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        ("dron", "tracker.kind: 'dron' is not allowed; did you mean 'drone'?"),
        ("nowhere.at_all:Plane", "tracker.kind: 'nowhere.at_all:Plane': there is no module "),
        ("math:pin", "tracker.kind: 'math:pin': the module 'math' has no 'pin'"),
        ("math:pi", "tracker.kind: 'math:pi' is a float, not a "),
        ("os:getcwd", "tracker.kind: 'os:getcwd' cannot be called with it (it is a built-in "),
        ("builtins:repr", "tracker.kind: 'builtins:repr' cannot be called with it (it "),
    ],
)
def test_what_is_no_tracker_is_told_in_one_line(kind, line):
    with pytest.raises(ConfigError) as caught:
        build_simulation(EyasConfig(tracker={"kind": kind}), each_alone(1))
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)


LOST = """
from dataclasses import replace

from eyas.lanes import kernel
from eyas.engine.trackers.drone import DRONE


@kernel(inline=True)
def advance(trackers, memory, n, command):
    trackers.position[n, 1] = trackers.position[n, 0] / 0.0 * 0.0


def Lost(config):
    return replace(DRONE, name="lost", advance=advance)
"""


@pytest.mark.slow  # its step is compiled
def test_one_that_flies_to_nowhere_is_told_in_one_line(config, monkeypatch, tmp_path):
    (tmp_path / "lost_tracker.py").write_text(LOST)
    monkeypatch.syspath_prepend(tmp_path)
    own = config.model_copy(update={"tracker": TrackerConfig(kind="lost_tracker:Lost")})
    simulation = build_simulation(own, each_alone(1))
    simulation.reset()
    with pytest.raises(EyasError, match=r"^place of a tracker: \[\[.*nan.*\]\] is not allowed"):
        simulation.advance(np.zeros((1, 4)), 5)
    sys.modules.pop("lost_tracker", None)


def test_the_original_s_file_cannot_name_it():
    with pytest.raises(ConfigError, match=r"^tracker\.kind: 'a\.b:C' cannot be expressed in env_"):
        to_original(EyasConfig(tracker={"kind": "a.b:C"}))
