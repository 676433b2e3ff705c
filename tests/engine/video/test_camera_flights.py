"""Camera paths: smooth, clear of all that stands and drives, and as much in view as is asked."""

import numpy as np
import pytest

from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.flights.plan import LIMITS
from eyas.engine.sim.flights.registry import PATHS, path_named
from eyas.engine.sim.worlds import each_alone
from eyas.engine.video.camera_flights import CameraFlights
from eyas.engine.video.logged_flights import LoggedFlight
from eyas.engine.video.run import recording_rules

STEPS = 1500
WILD = {"height": {"uniform": [8.0, 30.0]}, "pitch": {"uniform": [0.35, 1.3]}}
MAPS = ("citystreet", "downtown", "village")


def flown(map_name, name, count, steps, seed=0, start=None):
    """Fly episodes; return the states after each step: bodies, cameras, and whether one crashed."""
    settings = {"world": {"map": map_name}, "start": start or WILD, "video": {"flight": name}}
    settings["traffic"] = {"signals": "amber"}  # so that nobody stands, and all go their own way
    config = updated(EyasConfig(seed=seed), settings)
    config = updated(recording_rules(config), {"done": {"total_steps": steps, "crash": "contact"}})
    sim = build_simulation(config, each_alone(count))
    flights = CameraFlights(sim, config, path_named(name))
    sim.reset()
    flights.begin(np.arange(count), steps)
    bodies, angles, crashed = [], [], np.zeros(count, bool)
    snapshot = sim.snapshot
    for _ in range(steps):
        flights.move()
        bodies.append(snapshot.trackers.position.copy())
        yaw, pitch = snapshot.trackers.commanded_yaw, snapshot.trackers.commanded_gimbal[:, 0]
        angles.append(np.stack([yaw, pitch, snapshot.cameras.field_of_view], axis=1))
        crashed |= snapshot.episodes.crash
    return np.array(bodies), np.array(angles), crashed


def smooth(map_name, name, count):
    place, angles, crashed = flown(map_name, name, count, STEPS)
    assert not crashed.any()
    for order, most in ((2, LIMITS.acceleration), (3, LIMITS.jerk)):
        rate = np.linalg.norm(np.diff(place, n=order, axis=0), axis=2) / 0.002**order
        assert rate.max() <= 1.01 * most
    turns = np.unwrap(angles[..., :2], axis=0)
    assert np.abs(np.diff(turns, axis=0)).max() / 0.002 <= 1.01 * LIMITS.turn
    moved = np.linalg.norm(place[-1] - place[0], axis=1)
    assert np.ptp(place, axis=0).max() > 3.0  # they fly
    assert len({*moved.round(6).tolist()}) == count  # each its own way


@pytest.mark.slow
@pytest.mark.parametrize("name", PATHS.built_in)
@pytest.mark.parametrize("map_name", ["citystreet", "village"])
def test_flights_are_smooth_and_touch_nothing(map_name, name):
    smooth(map_name, name, 3)


@pytest.mark.thorough
@pytest.mark.parametrize("map_name", MAPS)
@pytest.mark.parametrize("name", PATHS.built_in)
def test_twenty_flights_are_smooth_and_touch_nothing(map_name, name):
    smooth(map_name, name, 20)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["follow", "zoom"])
def test_a_flight_is_the_same_beside_any_number_of_others(name):
    alone, several = (flown("citystreet", name, count, 300) for count in (1, 3))
    for one, many in zip(alone[:2], several[:2], strict=True):
        np.testing.assert_array_equal(one[:, 0], many[:, 0])
    other = flown("citystreet", name, 1, 300, seed=1)
    assert not np.array_equal(alone[0], other[0])


@pytest.mark.slow
def test_only_zoom_zooms():
    assert np.ptp(flown("village", "zoom", 4, 3000)[1][..., 2], axis=0).min() > 0.2
    assert np.ptp(flown("village", "orbit", 2, 500)[1][..., 2]) < 1e-12


def test_heights_and_pitches_are_those_asked_for():
    low, high = (
        flown("citystreet", "follow", 4, 300, start={"height": h})[0][..., 2].mean()
        for h in (10.0, 30.0)
    )
    assert high - low == pytest.approx(20.0, abs=3.0)


def test_a_path_of_ones_own(tmp_path, monkeypatch):
    (tmp_path / "own_paths.py").write_text(
        "import numpy as np\n"
        "from eyas import FlightSketch\n"
        "class Above:\n"
        "    in_view, searches = 1.0, False\n"
        "    def sketch(self, scene, rng):\n"
        "        lens = np.full(len(scene.time), scene.field_of_view)\n"
        "        return FlightSketch(scene.around(0.0, 1.0), scene.target, lens)\n"
        "class Half:\n"
        "    in_view = 1.0\n"
        "    searches = False\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    place, _, crashed = flown("citystreet", "own_paths:Above", 2, 400, start={"height": 20.0})
    assert not crashed.any()
    assert np.ptp(place[..., 2]) < 3.0
    with pytest.raises(ConfigError, match=r"^video.flight: 'own_paths:Half' .* no 'sketch'"):
        path_named("own_paths:Half")


def test_the_flight_of_a_log_is_flown_again_over_the_ground(tmp_path):
    path = tmp_path / "flight.csv"
    rows = (f"{k},{100 + 5 * k},{40 + 2 * k},{7 + k}\n" for k in range(10))
    path.write_text("t,x,y,z\n" + "".join(rows))
    video = {"flight": str(path), "start_time": 1.0, "warm_up_steps": 0}
    config = updated(EyasConfig(), {"video": video, "start": {"pitch": 0.9}})
    sim = build_simulation(recording_rules(config), each_alone(1))
    flights = CameraFlights(sim, config, LoggedFlight(path, sim, config))
    sim.reset()
    sim.snapshot.episodes.tick[:] = 500  # the first frame is now
    flights.begin(np.arange(1), 3000)
    places = []
    for _ in range(3000):
        flights.move()
        places.append(sim.snapshot.trackers.position[0].copy())
    places = np.array(places)
    time = 0.002 * np.arange(1, 3001)
    # Nothing is before the first point: the spline needs one step to leave it.
    np.testing.assert_allclose(places[20:, 0], 100 + 5 * time[20:], atol=0.02)
    np.testing.assert_allclose(places[20:, 1], 40 + 2 * time[20:], atol=0.02)
    np.testing.assert_allclose(places[1000:, 2], time[1000:], atol=0.02)  # 7 m is the ground here
    assert places[:, 2].min() >= 0.99
    assert float(sim.snapshot.trackers.commanded_gimbal[0, 0]) == pytest.approx(0.9)
