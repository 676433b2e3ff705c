"""Plans written for maps, checked, and flown over."""

import gzip
import json
import re
import shutil
from pathlib import Path

import gymnasium
import numpy as np
import pytest
import shapely
from typer.testing import CliRunner

from eyas.cli.app import app
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.sim.scenes import load_network, load_scene
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import Season
from eyas.maps.commands.plan import write_plan_of
from eyas.maps.plan.file import problems, read_plan
from eyas.maps.plan.plan import Buildings, GroundCover, Paved, Roadway

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_map.plan.json"


def eyas(*words):
    return CliRunner().invoke(app, ["maps", *map(str, words)])


def test_the_plan_of_a_map_is_that_map(tmp_path):
    path = tmp_path / "fields.plan.json.gz"
    done = eyas("plan", "farmland", "--out", path)
    assert (done.exit_code, done.stdout.strip()) == (0, str(path))
    plan, recipe = read_plan(path), MAPS.get(str(path))
    assert (recipe.name, plan.title) == ("farmland", MAPS.get("farmland").title)
    shipped = MAPS.get("farmland").roads(0)
    assert (recipe.roads(0).nodes, recipe.roads(0).edges) == (shipped.nodes, shipped.edges)
    assert eyas("check", path).exit_code == 0


@pytest.mark.slow
@pytest.mark.sumo
def test_a_map_of_a_file_has_the_scene_of_its_planner(tmp_path):
    path = tmp_path / "fields.plan.json"
    write_plan_of("farmland", 0, path)
    there, here = (load_scene(name, 0, Season.WINTER) for name in (str(path), "farmland"))
    assert there.static.positions.tobytes() == here.static.positions.tobytes()
    assert there.fixtures.pose.tobytes() == here.fixtures.pose.tobytes()


def test_a_file_of_another_name_is_refused(tmp_path):
    with pytest.raises(ConfigError, match=r"--out: 'x\.json' is not allowed: .*\.plan\.json"):
        write_plan_of("farmland", 0, tmp_path / "x.json")


def test_what_is_wrong_with_a_plan_is_told_one_line_each(tmp_path):
    content = json.loads(EXAMPLE.read_text())
    content["roads"]["edges"][0]["end"] = "nrth"
    content["library"] = [{"name": "bnch"}, {"name": "bench", "chance": "x"}]
    content["layers"] = [
        {"layer": "things", "kinds": ["bench", "bin"], "kind": [0, 2], "pose": [[0, 0, 0, 0, 1]]}
    ]
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    done = eyas("check", path)
    lines = [line.removeprefix(f"{path}: ") for line in done.stdout.splitlines()]
    assert done.exit_code == 1
    assert [line.partition(": ")[0] for line in lines] == [
        "library[0].name", "library[1].chance", "layers[0].kinds[1]", "layers[0].kind",
        "layers[0].kind",
    ]  # fmt: skip
    assert lines[0].endswith("did you mean 'bench'?")
    del content["layers"], content["library"]
    path.write_text(json.dumps(content))
    (line,) = problems(path)
    assert line.startswith(f"{path}: roads.edges[0].end: 'nrth' is not allowed: one of middle")
    with pytest.raises(DataFileError, match=r"roads\.edges\[0\]\.end: 'nrth'"):
        MAPS.get(str(path)).roads(0)


@pytest.mark.parametrize(
    ("index", "change", "said"),
    [
        (1, {"name": "n"}, "roads.edges[1].name: 'n' is not allowed: roads.edges[0] has that name"),
        (2, {"end": "north"}, "roads.edges[2].end: 'north' is not allowed: another node than its"),
        (0, {"lanes": 0}, "roads.edges[0].lanes: 0 is not allowed: above 0"),
        (0, {"lane_width": -3.5}, "roads.edges[0].lane_width: -3.5 is not allowed: above 0"),
        (3, {"speed": 0.0}, "roads.edges[3].speed: 0.0 is not allowed: above 0"),
    ],
)
def test_roads_that_cannot_be_are_refused_before_sumo_sees_them(index, change, said, tmp_path):
    content = json.loads(EXAMPLE.read_text())
    content["roads"]["edges"][index] |= change
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    (line,) = problems(path)
    assert line.startswith(f"{path}: {said}")


def test_a_field_of_several_types_has_one_error(tmp_path):
    content = json.loads(EXAMPLE.read_text())
    content["survey"]["houses"][3]["roof"] = "hiped"
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    (line,) = problems(path)
    assert line.startswith(f"{path}: survey.houses[3].roof: 'hiped' is not allowed: 'flat', ")
    assert line.endswith("did you mean 'hipped'?")


def test_a_plan_that_is_not_there_is_told(tmp_path):
    with pytest.raises(DataFileError, match=r"no\.plan\.json: cannot read: No such file"):
        MAPS.get(str(tmp_path / "no.plan.json"))


@pytest.fixture(scope="module")
def hamlet(tmp_path_factory):
    """The path of the plan drawn by hand."""
    return shutil.copy(EXAMPLE, tmp_path_factory.mktemp("plans") / "hamlet.plan.json")


@pytest.mark.sumo
def test_a_plan_drawn_by_hand_is_completed(hamlet):
    known = read_plan(Path(hamlet)).survey
    network, recipe = load_network(str(hamlet), 0), MAPS.get(str(hamlet))
    made = recipe.complete_plan(network, 0)
    assert made.survey is None
    buildings = next(layer for layer in made.layers if isinstance(layer, Buildings))
    assert len(buildings.items) == len(known.houses)
    tall = max(buildings.items, key=lambda one: one.parts[0].height).parts[0]
    assert tall.height == pytest.approx(27.3)  # nine storeys
    flat = [layer.area for layer in made.layers if isinstance(layer, Roadway | Paved)]
    flat += [
        piece.area
        for layer in made.layers
        if isinstance(layer, GroundCover) and layer.kind is not ObjectClass.WATER
        for piece in layer.pieces
        if piece.form == "flat"
    ]
    joined = shapely.union_all(flat)
    assert sum(area.area for area in flat) == pytest.approx(joined.area, rel=2e-4)
    pond = shapely.Polygon(known.areas[0].shape)
    assert joined.area + pond.area == pytest.approx(400 * 400, rel=2e-3)
    other = recipe.complete_plan(network, 1)
    assert other.seed == 1
    assert recipe.complete_plan(network, 0).layers[1] == made.layers[1]


@pytest.mark.slow
@pytest.mark.sumo
def test_a_plan_drawn_by_hand_flies(hamlet):
    settings = {"world": {"map": str(hamlet)}, "traffic": {"max_vehicles": 3}}
    env = gymnasium.make("eyas/citystreet-day-v0", config=settings)
    first, _ = env.reset(seed=3)
    for _ in range(10):
        later, _, ended, cut, _ = env.step(env.action_space.sample())
        assert not cut
        assert not ended
    assert (np.asarray(later) != first).any()
    scene = load_scene(str(hamlet), 0)
    count = np.bincount(scene.object_class, minlength=len(ObjectClass))
    assert count[ObjectClass.BUILDING] == 7
    assert count[ObjectClass.WATER] == 1
    assert len(scene.lamps.position) > 10
    assert scene.footways.told
    assert len(scene.footways.crossings) == 2


NET = """<net version="1.20">
<edge id="a" from="s" to="e"><lane id="a_0" index="0" speed="13" width="3.2" shape="{}"/></edge>
<junction id="s" shape="0,0 1,0 1,1"/><junction id="e" shape="9,0 9,1 8,1"/>
</net>"""


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (NET.format("-50,0 50,0"), ""),
        (gzip.compress(NET.format("-50,0 50,0").encode()), ""),
        (NET.format("11000,0 12000,0"), "2 of 2 points of its lanes are outside of size"),
        (NET.format("-50,0 1e300,0"), "'lane_points' are not all within 100 km"),
        (NET.format("-50,0 nan,0"), "'lane_points' are not all within 100 km"),
        (NET.format("-50,x"), "not a network of SUMO: a shape: could not convert"),
        (NET.format("0,0 1,1").replace('speed="13"', 'speed="inf"'), "<edge>: inf is not allowed"),
        (NET.format("0,0 1,1").replace(' id="a"', ""), "<edge> without 'id'"),
        ("<osm/>", "not a network of SUMO: its content is <osm>"),
        ("<net>", "not a network of SUMO: no element found"),
        (lambda: gzip.compress(b" " * (257 << 20), 1), "larger than 256 MiB when unpacked"),
        (gzip.compress(NET.encode())[:-9], "cannot read"),
    ],
)
def test_the_roads_that_a_plan_names_are_opened(tmp_path, content, line):
    name = "roads.net.xml"
    content = content() if callable(content) else content  # a large one where it is wanted only
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    path = tmp_path / "own.plan.json"
    plan = {"format": "eyas-plan-1", "name": "own", "size": [200, 200], "roads": {"file": name}}
    path.write_text(json.dumps(plan))
    done = eyas("check", path)
    assert (done.exit_code, len(done.stdout.splitlines())) == (int(bool(line)), 1)
    assert line in done.stdout
    if not line:
        assert len(load_network(str(path), 0).lane_points) == 2


@pytest.mark.parametrize("number", [1e300, -1.7e308, 2e6, 10**400])
def test_absurd_numbers_of_a_plan_are_one_short_line(tmp_path, number):
    content = json.loads(EXAMPLE.read_text())
    content["size"] = [300, number]
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    try:
        (line,) = problems(path)
    except DataFileError as error:
        line = str(error)
    assert re.search("size.*is not allowed|the number -?1.* is not allowed", line)
    assert len(line) < 300
