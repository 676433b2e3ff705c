"""Targets of one's own, from the settings to the picture."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.cli.targets.check import check
from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.kind import _spoken, kind_name_of
from eyas.engine.mesh.shell import Shell
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.scenes import load_scene
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.mesh import Material
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import MODELS, kind_index, models_of
from eyas.engine.targets.kind import Looks, Model
from eyas.engine.targets.rig import Rigs

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(autouse=True)
def importable(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    yield
    for name in ("own_mesh", "own_target", "own_track"):
        sys.modules.pop(name, None)


def begun(**settings: object) -> Simulation:
    start = {"pitch": 1.37, "height": 9.0}
    config = validated(SimConfig, {"start": start, "extras": [], **settings})
    simulation = build_simulation(config, together(1))
    simulation.reset()
    return simulation


def seen(simulation: Simulation) -> tuple[Model, Picture, np.ndarray]:
    """Return the target's model, a picture and where the target is in it."""
    picture = Picture.create(1, 60, 80, object_id=True, class_id=True)
    simulation.draw(np.zeros(1, np.int32), picture)
    targets = simulation.snapshot.targets
    shown = picture.object_id[0] == ACTOR_OBJECT + targets.actor[0]
    assert shown.any()
    return MODELS[targets.model[0]], picture, shown


@pytest.mark.slow
def test_a_mesh_file_is_followed_and_drawn():
    pytest.importorskip("trimesh")
    import own_mesh

    simulation = begun(custom=own_mesh.ROBOT)
    simulation.carry(500)
    model, picture, shown = seen(simulation)
    assert model.typename == "own_mesh"
    np.testing.assert_allclose(model.size, (0.9, 0.68, 1.3), atol=1e-6)
    assert set(picture.class_id[0][shown]) == {ObjectClass.ROBOT}
    speed = simulation.traffic.motion.table["velocity_x"]
    assert np.abs(speed).max() <= 1.51
    assert np.abs(speed).max() > 1.0


def test_a_class_brings_its_parts_and_its_motion():
    import own_target

    simulation = begun(
        custom={"path": "own_target:Sprinkler"}, objects={"max_count": 3}, world={"map": "farmland"}
    )
    before = simulation.snapshot.targets.position[0].copy()
    simulation.carry(500)
    model, picture, shown = seen(simulation)
    assert (model.typename, model.size) == ("Sprinkler", own_target.Sprinkler.size)
    moved = np.hypot(*(simulation.snapshot.targets.position[0] - before)[:2])
    assert moved == pytest.approx(2.0, rel=0.02)  # 2 m/s for a second
    assert simulation.traffic.actors == 3
    arm = picture.rgb[0][shown].astype(int)
    assert (arm[:, 0] > 1.5 * arm[:, 2]).any()  # yellow
    table = (
        begun(
            custom={"path": "own_target:Sprinkler"},
            objects={"max_count": 3},
            world={"map": "farmland"},
        )
        .traffic.motion.sampled()
        .table
    )
    np.testing.assert_array_equal(table, simulation.traffic.motion.sampled().table)


@pytest.mark.slow
def test_a_trajectory_moves_any_body_and_begins_again():
    import own_track

    points = np.genfromtxt(EXAMPLES / "own_track.csv", delimiter=",", names=True)
    last = round(points["t"][-1] * 10)
    for body in ("Pedestrian", "bus"):
        simulation = begun(custom={**own_track.WALK, "body": body})
        assert seen(simulation)[0].kind == body
        first, second = simulation.traffic.motion.sampled().table.T
        np.testing.assert_allclose(first["x"][: last + 1 : 10], points["x"], atol=1e-3)
        assert (np.diff(first["travelled"][: last + 1]) >= 0.0).all()
        assert first["present"][last]
        assert not first["present"][last + 1]
        # The next one begins as it ends, and so on: there is always one.
        assert second["x"][last] == first["x"][0] == first["x"][2 * last]
        assert (first["present"] + second["present"] > 0.0).all()


@pytest.mark.slow
def test_a_pedestrian_who_crosses_roads_is_followed():
    crossing = {"body": "Pedestrian", "behaviour": "crossing", "speed": 1.6}
    few = {"max_count": 4, "group_size": 4, "interval": 20.0}
    cars = [{"kind": "SUMO_VEHICLE", "count": 30}]
    simulation = begun(custom=crossing, objects=few, extras=cars)
    model, _, _ = seen(simulation)
    assert (model.kind, model.typename) == ("Pedestrian", "Pedestrian")
    table = simulation.traffic.motion.sampled().table[:, 30:34]
    speed = np.hypot(table["velocity_x"], table["velocity_y"])
    assert 1.05 < speed.max() < 1.61
    walking, on_road = table["present"] > 0.0, table["z"] < 0.05
    assert 0.02 < (on_road & walking).sum() / walking.sum() < 0.3


def test_a_short_trajectory_is_followed_for_ever_by_shorter_episodes(tmp_path: Path):
    (tmp_path / "short.csv").write_text("t,x,y\n0,0,0\n1,1,0\n2,2,0\n")
    simulation = begun(custom={"trajectory": str(tmp_path / "short.csv")})
    for _ in range(30):  # 12 s, in one world whose time goes on
        ended = simulation.carry(200).done
        if ended.any():
            simulation.reset(ended)
    assert simulation.snapshot.episodes.number[0] > 3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["own_mesh", "own_target", "own_track"])
def test_the_examples_run(name: str, capsys: pytest.CaptureFixture[str]):
    if name == "own_mesh":
        pytest.importorskip("trimesh")
    __import__(name).main()
    assert "pixels, reward" in capsys.readouterr().out


class Sizeless:
    size = (1.0, 0.0, 1.0)

    def parts(self):
        return []

    def pose(self, ride):
        return np.zeros((1, 1, 3, 4))


class Partless(Sizeless):
    size = (1.0, 1.0, 1.0)


class Crooked(Partless):
    def parts(self):
        shell = Shell()
        shell.box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0), Material())
        return [shell.mesh(), shell.mesh()]


class Whole(Crooked):
    def pose(self, ride):
        return np.tile(np.eye(3, 4), (len(ride.speed), 2, 1, 1))


class Failing(Whole):
    def parts(self):
        raise RuntimeError("no\nparts today")


class Unreadable(Whole):
    @property
    def size(self):
        raise OSError("no such size")


class Slim(Whole):
    size = (5.0, 1.0, 1.0)


class Stout(Whole):
    size = (1.0, 0.8, 1.0)


class Wordy(Whole):
    size = "large"


class Greedy(Whole):
    def __init__(self, name):
        self.name = name


class Ragged(Whole):
    def pose(self, ride):
        return [[1.0, 2.0], [3.0]]


class Tired(Whole):
    def pose(self, ride):
        if ride.travelled.max() > 30.0 and len(ride.speed) < 9:
            raise RuntimeError("no\nfarther")
        return super().pose(ride)


class Lost(Whole):
    def tracks(self, scene, time, count, rng):
        return np.full((len(time), count, 3), 1e5)


class Jumping(Whole):
    def tracks(self, scene, time, count, rng):
        ways = np.zeros((len(time), count, 3))
        ways[50:, -1, 0] = 200.0
        return ways


class Narrow(Whole):
    def tracks(self, scene):
        return 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("custom", "message"),
    [
        ({}, "custom.mesh: .*must be given, or path, trajectory or behaviour"),
        (
            {"mesh": "a.obj", "path": "a:B"},
            r"custom\.path: .*must be left out where a mesh is given",
        ),
        ({"path": "nowhere:Fox"}, r"custom\.path: 'nowhere:Fox': there is no module 'nowhere'"),
        ({"path": "math:pi"}, r"custom\.path: 'math:pi' is a float"),
        ({"path": "pathlib:PurePath"}, "has not all of: size, parts"),
        ({"path": f"{__name__}:Sizeless"}, "size is .*allowed: three lengths above 0"),
        ({"path": f"{__name__}:Partless"}, r"parts\(\) must return one or more meshes"),
        (
            {"path": f"{__name__}:Crooked"},
            r"pose\(ride\) of 2 bodies after 1 m returned an array of shape \(1, 1, 3, 4\); a",
        ),
        (
            {"path": f"{__name__}:Failing"},
            r"parts\(\) raised RuntimeError: no parts today \(.*own\.py, line \d+\)$",
        ),
        ({"path": f"{__name__}:Unreadable"}, "raised OSError: no such size"),
        ({"path": f"{__name__}:Wordy"}, "size is 'large'; allowed: three lengths"),
        (
            {"path": f"{__name__}:Greedy"},
            "made without arguments is needed; it cannot be called so: .*'name'$",
        ),
        (
            {"path": f"{__name__}:Ragged"},
            r"2 bodies after 1 m returned no array of numbers; allowed",
        ),
        ({"path": f"{__name__}:Narrow"}, r"tracks\(...\) raised TypeError: "),
        ({"path": f"{__name__}:Lost"}, r"body 1 of 10: .* are outside the map 'citystreet'"),
        ({"path": f"{__name__}:Jumping"}, "body 10 of 10: point 51: it jumps 200 m in 0.1 s"),
        ({"mesh": "gone.stl"}, r"^custom\.mesh: gone\.stl: cannot read: no such file in /"),
        ({"trajectory": "gone.csv"}, r"^custom\.trajectory: gone\.csv: cannot read: "),
        ({"mesh": "a.obj", "smoothing": 1.0}, "smoothing: .*must be left out where no trajectory"),
        ({"trajectory": "x.csv", "smoothing": -1}, r"custom\.smoothing: -1 .*allowed: .*0"),
        ({"trajectory": "x.csv", "smoothing": 1e9}, r"custom\.smoothing: 1000000000\.0 .* 10"),
        ({"trajectory": "x.csv", "smoothing": "much"}, r"custom\.smoothing: 'much' .*number"),
        ({"trajectory": "x.csv", "body": "Pedestrien"}, "did you mean 'Pedestrian'"),
        ({"path": "a:B", "behaviour": "wonder"}, r"custom\.behaviour: .*did you mean 'wander'"),
    ],
)
def test_what_cannot_be_used_is_told_in_one_line(custom, message, monkeypatch):
    monkeypatch.setitem(sys.modules, __name__, sys.modules.get(__name__, _this()))
    with pytest.raises(ConfigError, match=message):
        begun(custom=custom)


def test_what_a_class_raises_in_flight_is_told_in_one_line(tmp_path: Path, monkeypatch):
    monkeypatch.setitem(sys.modules, __name__, sys.modules.get(__name__, _this()))
    (tmp_path / "fast.csv").write_text("t,x,y\n0,0,0\n20,200,0\n")
    custom = {"path": f"{__name__}:Tired", "trajectory": str(tmp_path / "fast.csv")}
    simulation = begun(custom=custom)
    seen(simulation)
    simulation.carry(2000)  # 4 s, 40 m
    told = (
        r"Tired': pose\(ride\) of 1 body after [34]\d(\.\d+)? m raised RuntimeError: no farther \("
    )
    with pytest.raises(ConfigError, match=told):
        seen(simulation)


def _this():
    import types

    module = types.ModuleType(__name__)
    module.__dict__.update(globals())
    return module


def test_who_walks_by_a_trajectory_stands_on_pavements_and_lawns(tmp_path: Path):
    scene = load_scene("citystreet")
    spots = {ObjectClass.PAVEMENT: 0.15, ObjectClass.ROAD: 0.0}
    kinds = scene.object_class[scene.static_object]
    for kind, height in spots.items():
        corners = scene.static.positions[scene.static.triangles[kinds == kind]].astype(np.float64)
        level = (
            np.ptp(corners[..., 2], axis=1) + np.abs(corners[..., 2] - height).max(axis=1) < 0.02
        )
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        x, y, _ = corners[np.argmax(np.where(level, across[:, 2], 0.0))].mean(axis=0)
        track = tmp_path / f"{kind.name}.csv"
        track.write_text(f"t,x,y\n0,{x},{y}\n60,{x + 0.1},{y}\n")
        table = begun(custom={"trajectory": str(track)}).traffic.motion.sampled().table
        assert table["z"][0, 0] == pytest.approx(height, abs=0.02)


@pytest.mark.slow
def test_a_trajectory_climbs_with_the_ground_or_as_it_says(tmp_path: Path):
    terrain = load_scene("village").terrain
    rise = np.diff(terrain.relief.astype(np.float64), axis=1) / terrain.spacing
    row, column = np.argwhere(np.abs(rise - 0.2) < 0.02).T
    x = terrain.west + (column + 0.2) * terrain.spacing
    y = terrain.south + row * terrain.spacing
    nearest = np.argmin(np.hypot(x, y))
    x, y = x[nearest], y[nearest]
    steps = [(0, 0.0), (1, 0.3), (2, 0.6)]
    for heights in (False, True):
        track = tmp_path / f"climb{heights}.csv"
        lines = [f"{t},{x + d},{y}" + f",{3 + 0.4 * t}" * heights for t, d in steps]
        track.write_text("t,x,y" + ",z" * heights + "\n" + "\n".join(lines))
        custom = {"trajectory": str(track), "body": "BB-8"}
        motion = begun(custom=custom, world={"map": "village"}).traffic.motion
        row = motion.sampled().table[10, 0]
        assert row["velocity_x"] == pytest.approx(0.3, abs=0.01)
        if heights:
            told = row["z"], row["velocity_z"], row["slope"]
            assert told == pytest.approx((3.4, 0.4, 0.0), abs=0.01)
        else:
            assert np.tan(row["slope"]) == pytest.approx(0.2, abs=0.05)
            assert row["velocity_z"] == pytest.approx(0.06, abs=0.02)


def test_a_target_of_ones_own_tilts_with_its_ground(monkeypatch):
    monkeypatch.setitem(sys.modules, __name__, _this())
    name = kind_name_of(CustomConfig(path=f"{__name__}:Whole"))
    rigs, actors = Rigs(np.array([kind_index(name)], np.int32)), ActorState.create(1, 1)
    actors.present[:], actors.yaw[:], actors.slope[:] = True, np.pi / 2, 0.3
    actors.position[0, 0] = 1.0, 2.0, 3.0
    model = np.full((1, 1), models_of(kind_index(name)).start, np.int32)
    out = rigs.draw_list(1)
    rigs.pose(actors, Looks(model, np.ones((1, 1, 3), np.float32)), out)
    ahead, left, up, origin = out.pose[0, 0].T
    np.testing.assert_allclose(ahead, [0.0, np.cos(0.3), np.sin(0.3)], atol=1e-6)
    np.testing.assert_allclose(left, [-1.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(up, np.cross(ahead, left), atol=1e-6)
    np.testing.assert_allclose(origin, [1.0, 2.0, 3.0], atol=1e-6)


def test_words_are_made_of_any_name():
    assert _spoken("DeliveryRobot") == "a delivery robot"
    assert _spoken("delivery_robot-2") == "a delivery robot 2"
    assert _spoken("ROSBot") == "a ros bot"
    assert _spoken("Straßengerät größer") == "a straßengerät größer"


def test_a_trajectory_outside_the_map_is_told_before_anything_moves(tmp_path: Path):
    (tmp_path / "far.csv").write_text("t,x,y\n0,9000,0\n1,9001,0\n")
    with pytest.raises(ConfigError, match=r"2 of 2 points are outside the map 'citystreet'"):
        begun(custom={"trajectory": str(tmp_path / "far.csv")})


def test_check_tells_whether_a_target_can_be_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    settings = CustomConfig(path="-")
    assert check("BB-8", settings, "citystreet") == (["usable: BB-8"], True)
    lines, usable = check("own_target:Sprinkler", settings, "farmland")
    assert (lines, usable) == (
        ["note: 2 parts, 3.2 x 3.2 x 1.1 m", "usable: own_target:Sprinkler"],
        True,
    )
    lines, usable = check(str(EXAMPLES / "own_track.csv"), settings, "citystreet")
    assert usable
    assert lines[0].startswith("note: 81 points in 80 s, ")
    back = tmp_path / "back.csv"
    back.write_text("t,x,y\n1,0,0\n0,1,0\n")
    lines, usable = check(str(back), settings, "citystreet")
    assert not usable
    assert lines[0].endswith("point 2: t is 0 after 1: time must increase")
    monkeypatch.setitem(sys.modules, __name__, _this())
    for name in ("Slim", "Stout"):
        lines, usable = check(f"{__name__}:{name}", settings, "citystreet")
        assert usable
        assert "what is drawn at rest (x -0.5 to 0.5, " in lines[1]
    for name, text, told in (
        ("degrees", "".join(f"{k},11.5{k},48.1\n" for k in range(12)), "are x and y degrees"),
        ("rare", "0,0,0\n100000,1,0\n200000,2,0\n", "is t in milliseconds"),
    ):
        track = tmp_path / f"{name}.csv"
        track.write_text("t,x,y\n" + text)
        assert told in check(str(track), settings, "citystreet")[0][0]
    aloft = tmp_path / "aloft.csv"
    aloft.write_text("t,x,y,z\n0,0,0,500\n1,1,0,500\n")
    assert check(str(aloft), settings, "citystreet")[0][0].startswith("note: it is up to 500 m ab")
    with pytest.raises(UnknownNameError, match="did you mean 'Mantis'"):
        check("Mantes", settings, "citystreet")


def test_a_convoy_of_tracks_drives_as_they_did(tmp_path: Path):
    files = []
    for name, second in (("a", 0.0), ("b", 2.0)):
        path = tmp_path / f"{name}.csv"
        rows = (f"{1.7e9 + second + k},{2.0 * k},0\n" for k in range(40))
        path.write_text("time,x,y\n" + "".join(rows))
        files.append(str(path))
    custom = {"trajectory": files, "at": (10.0, 20.0, math.pi / 2), "body": "BB-8"}
    sampled = begun(custom=custom).traffic.motion.sampled()
    table, rate = sampled.table, round(sampled.rate)
    first, second = table[:, 0], table[:, 2]
    assert first["present"][:rate].all()
    assert not second["present"][: 2 * rate].any()
    assert second["present"][2 * rate : 5 * rate].all()
    np.testing.assert_allclose(first["x"][: 5 * rate], 10.0, atol=1e-6)  # turned to the north
    np.testing.assert_allclose(first["y"][5 * rate], 20.0 + 10.0, atol=0.05)
    np.testing.assert_allclose(second["y"][5 * rate], 20.0 + 6.0, atol=0.05)
