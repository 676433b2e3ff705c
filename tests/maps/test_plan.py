"""Plans of maps: their files, what is refused, and the scenes that are made of them."""

import ast
import inspect
import json
import re
from dataclasses import fields, is_dataclass
from hashlib import blake2b

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from eyas.engine.core.errors import DataFileError
from eyas.engine.sim.scenes import _text_of, load_scene
from eyas.engine.state.mesh import Material, Surface
from eyas.engine.state.scene import ObjectClass
from eyas.engine.world.maps import MAPS
from eyas.engine.world.weather import Season
from eyas.maps.build.heights import FLOOR_HEIGHT
from eyas.maps.land.mounds import Mound
from eyas.maps.land.relief import relief_of
from eyas.maps.osm.features import House, Survey
from eyas.maps.plan import build, plan
from eyas.maps.plan.build import build_scene
from eyas.maps.plan.file import plan_of, problems, read_plan, text_of, write_plan

HASHES = {
    ("citystreet", "summer"): "19bbef7c7875170a",
    ("downtown", "summer"): "48251ae6d4bc0a4f",
    ("lake", "summer"): "5fada6b8a8f2a685",
    ("lake", "winter"): "9737fc5d8724b7fb",
    ("village", "summer"): "1a6f84dce2e52a3f",
    ("village-bare", "summer"): "e58169f765701c91",
    ("desert", "summer"): "66d5461203636f8f",
    ("desert", "winter"): "ddbd5bdaf2ce7f70",
    ("desert-bare", "summer"): "386172c8d66cb518",
    ("farmland", "summer"): "aa2828fda069eda7",
    ("farmland", "winter"): "d5032fbf66dc2cd3",
    ("farmland-bare", "summer"): "32fb55d60f00e8e0",
    ("simpleway-grass", "summer"): "f6001c0b4ec0d85d",
    ("simpleway-grass", "winter"): "13d897b572c97b5e",
    ("simpleway-clinker", "summer"): "0cf032568e3a5135",
    ("simpleway-desert", "summer"): "f0fe7df5139cf9b7",
    ("simpleway-desert", "winter"): "f9eff05a2f1467d2",
    ("simpleway-farm", "summer"): "9144b50f08791c2b",
    ("simpleway-lake", "summer"): "14d2fe4165a6559b",
    ("simpleway-village", "summer"): "0ba3909a68765401",
    ("simpleway-city", "winter"): "eb6f63fabda02fb1",
}
"""Of all arrays of the scenes, without roads and footways."""
QUICK = ("farmland", "village-bare")
"""Maps that are planned and built in a second."""
SLOW = [
    name
    for name in MAPS.built_in
    if name not in QUICK and (name == "simpleway-farm" or "simpleway" not in name)
]
"""The others; of the simple maps, whose plans differ by their ground only, one."""
SOME = ("citystreet",)
"""Those of them that are not left to a release."""
ON_GROUND = ("flat", "field")


def leaves(thing, path=""):
    """Yield the arrays and other values of a scene, with their places."""
    if isinstance(thing, np.ndarray):
        yield path, thing
    elif is_dataclass(thing):
        for field in fields(thing):
            yield from leaves(getattr(thing, field.name), f"{path}.{field.name}")
    elif isinstance(thing, tuple | list):
        for index, part in enumerate(thing):
            yield from leaves(part, f"{path}[{index}]")
    else:
        yield path, thing


def digest(scene):
    made = blake2b(digest_size=8)
    for path, value in leaves(scene):
        if path.startswith((".network", ".footways")):
            continue
        made.update(path.encode())
        if isinstance(value, np.ndarray):
            made.update(f"{value.dtype.str}{value.shape}".encode())
            made.update(np.ascontiguousarray(value).data)
        else:
            made.update(repr(value).encode())
    return made.hexdigest()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "season"), HASHES, ids=map("-".join, HASHES))
def test_scenes_have_the_bytes_that_they_had(name, season):
    assert digest(load_scene(name, 0, Season(season))) == HASHES[name, season]


def round_trip(name, tmp_path):
    recipe = MAPS.get(name)
    network = recipe.shipped_network()
    made = recipe.plan(network, 0)
    path = tmp_path / "map.plan.json.gz"
    write_plan(path, made)
    again = read_plan(path)
    assert text_of(again) == text_of(made)
    for season in Season if recipe.seasons else [Season.SUMMER]:
        found, expected = build_scene(again, network, season), load_scene(name, 0, season)
        assert digest(found) == digest(expected)


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_a_scene_of_a_file_is_that_of_its_planner(name, tmp_path):
    round_trip(name, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [name if name in SOME else pytest.param(name, marks=pytest.mark.thorough) for name in SLOW],
)
def test_a_scene_of_a_file_is_that_of_its_planner_on_every_map(name, tmp_path):
    round_trip(name, tmp_path)


def areas_of(made, season):
    """Yield all areas of a plan that lie level on the floor or on the road, from above [m]."""
    for layer in made.layers:
        if isinstance(layer, plan.Roadway | plan.Paved):
            yield layer.area
            if isinstance(layer, plan.Roadway) and layer.bays is not None:
                yield layer.bays
        elif isinstance(layer, plan.GroundCover) and layer.season in (None, season):
            for piece in layer.pieces:
                if piece.form in ON_GROUND and layer.kind is not ObjectClass.STRUCTURE:
                    # Thin sand lies over the asphalt.
                    over = piece.z > 0.0 and piece.form == "flat" and piece.sides is None
                    if not over:
                        yield piece.area


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in MAPS.built_in if "simpleway" not in name])
def test_no_two_covers_overlap_and_nothing_on_the_floor_is_bare(name):
    made = plan_of(_text_of(name, 0).tobytes())
    areas = list(areas_of(made, "summer"))
    total, joined = sum(area.area for area in areas), shapely.union_all(areas)
    assert total == pytest.approx(joined.area, rel=2e-4)
    floor = shapely.box(-made.size[0] / 2, -made.size[1] / 2, made.size[0] / 2, made.size[1] / 2)
    rising = [layer for layer in made.layers if isinstance(layer, plan.Hills)]
    raised = [relief_of(layer, 0).area for layer in rising]
    built = [
        one.parts[0].outline
        for layer in made.layers
        if isinstance(layer, plan.Buildings)
        for one in layer.items
    ]
    bare = shapely.difference(floor, shapely.union_all([joined, *raised, *built]))
    # Buildings stand in yards with paving only around them; ponds lie lower, inside of their rims.
    assert bare.area < 2e-4 * floor.area


def sample():
    """A plan with a layer of each sort."""
    made = json.loads(_text_of("desert", 0).tobytes())
    square = [[0, 0], [9, 0], [9, 9], [0, 9]]
    shell = {"outline": square, "height": 6.0, "facade": "facade_brick", "cover": {}}
    chance = {"stream": "x"}
    stripe = {"middle": [[0, 0], [1, 1]], "width": 0.2}
    pillar = {"place": [0, 0], "across": [1, 0], "top": 5.0}
    line = {"start": [0, 0], "along": [1, 0], "length": 9.0, "bents": [1.0], "over": [2.0]}
    skyway = {"start": [0, 0], "end": [9, 0], "width": 3.0, "floors": 1, "facade": "facade_glass",
              "tint": [1, 1, 1]}  # fmt: skip
    made["layers"] = [
        {"layer": "buildings", "items": [{"parts": [shell], "fittings": ["tank"]}]},
        {"layer": "backdrop", "outlines": [square], "tops": [9.0], "walls": [{}], "roofs": [{}],
         "bays": [[[0, 1]] * 4]},
        {"layer": "things", "kinds": ["bench"], "kind": [0], "pose": [[0, 0, 0, 0, 1.0]]},
        {"layer": "roadway", "area": square, "wear": chance,
         "paint": {"lines": [stripe], "bars": [stripe], "shapes": [square]}},
        {"layer": "paved", "area": square, "beside": []},
        {"layer": "ground", "pieces": [
            {"form": "flat", "area": square, "cover": {"texture": "lawn"}},
            {"form": "heap", "area": square, "z": 0.1, "cover": {}},
            {"form": "field", "area": square, "z": 0.1, "cover": {}, "winter": {}, "north": True},
            {"form": "far", "rule": "plain", "covers": [{}]}]},
        {"layer": "deck", "middle": [[0, 0, 0]], "pillars": [pillar], "descent": [[0, 0, 0]],
         "legs": []},
        {"layer": "tunnels", "items": [{"place": [0, 0], "along": [1, 0], "length": 9.0}],
         "outside": {}, "inside": {}, "chance": chance},
        {"layer": "hills", "mounds": [{"x": 0.0, "y": 0.0, "radius": 9.0, "height": 5.0}],
         "flat": [], "half": [9.0, 9.0], "spacing": [1.0, 1.0], "chance": chance, "covers": [{}]},
        {"layer": "skyways", "items": [skyway]},
        {"layer": "railway", "line": {**line, "station": 4.0}},
    ]  # fmt: skip
    made["library"] = [{"name": "bench"}]
    made["roads"] = {"nodes": [{"name": "a", "x": 0.0, "y": 0.0}, {"name": "b", "x": 9, "y": 0.0}],
                     "edges": [{"name": "ab", "start": "a", "end": "b"}]}  # fmt: skip
    made["survey"] = {"houses": [{"shape": square}], "areas": [{"kind": "park", "shape": square}],
                      "trees": [[0.0, 0.0, 5.0]]}  # fmt: skip
    return made


def told_of(tmp_path, content):
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    return path, problems(path)


@pytest.mark.slow
def test_every_layer_is_in_the_sample(tmp_path):
    assert told_of(tmp_path, sample())[1] == []
    layers = {part["layer"] for part in sample()["layers"]}
    union = plan.Layer.__args__[0]
    assert layers == {one.__metadata__[0].tag for one in union.__args__}


def places(value, path=""):
    """Yield the path of each value of a JSON document, and how to set it."""
    if isinstance(value, dict):
        for key, part in value.items():
            yield f"{path}.{key}".lstrip("."), value, key
            yield from places(part, f"{path}.{key}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for index, part in enumerate(value):
            yield from places(part, f"{path}[{index}]")


WRONG = (float("nan"), {"no": "such"}, "no such thing", -1e9, [], None, [["x"]])


@pytest.mark.slow
def test_every_field_is_refused_in_one_line_when_it_is_wrong(tmp_path):
    whole = sample()
    checked = 0
    for path, holder, key in list(places(whole)):
        kept = holder[key]
        refusals = []
        for wrong in WRONG:
            holder[key] = wrong
            try:
                _, told = told_of(tmp_path, whole)
            except DataFileError as error:
                told = [str(error)]
            refusals += told
            for line in told:
                assert "\n" not in line
                assert line.startswith(f"{tmp_path}"), line
        holder[key] = kept
        assert refusals, path
        leaf = re.sub(r"\[0\]$", "", path)
        assert any(leaf in line for line in refusals), (path, refusals)
        checked += 1
    assert checked > 120


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"siez": [9, 9]}, r"siez: unknown key; did you mean 'size'\?; known: name, title"),
        ({"size": [900.0, 0.0]}, r"size\[1\]: 0.0 is not allowed: greater than 0"),
        ({"seed": True}, r"seed: true is not allowed"),
        ({"name": "two words"}, "name: 'two words' is not allowed"),
        ({"layers": [{"layer": "thing"}]}, r"layers\[0\]\.layer: 'thing' is not allowed: one of "),
        ({"layers": [{}]}, r"layers\[0\]\.layer: is missing"),
        ({"layers": [{"layer": "roadway", "area": []}]}, r"layers\[0\]\.wear: is missing"),
        ({"format": "eyas-plan-0"}, r"format: 'eyas-plan-0' is not allowed: a plan has"),
    ],
)
def test_errors_name_the_field_its_value_and_what_is_allowed(change, said, tmp_path):
    content = {"format": "eyas-plan-1", "name": "x", "size": [9.0, 9.0]} | change
    path = tmp_path / "odd.plan.json"
    path.write_text(json.dumps(content))
    with pytest.raises(DataFileError, match=f"^{re.escape(str(path))}: {said}"):
        read_plan(path)


@pytest.mark.parametrize("content", ["", "[]", "{", "null", '{"format": 3}', "\x1f\x8bno gzip"])
def test_what_is_no_plan_is_refused(content, tmp_path):
    path = tmp_path / "x.plan.json"
    path.write_bytes(content.encode("latin-1"))
    with pytest.raises(DataFileError, match=r"x\.plan\.json: "):
        read_plan(path)


numbers = st.floats(-1e6, 1e6, allow_nan=False)
corners = st.floats(-1e6, 9.99e5)  # no side of a box is longer than 99 m
shares = st.floats(0.0, 1.0)
colours = st.tuples(shares, shares, shares)
covers = st.builds(
    Material, st.sampled_from(["plain", "lawn", "water"]), colours, st.sampled_from(Surface),
    st.floats(0.0, 9.0),
)  # fmt: skip
boxes = st.builds(
    lambda x, y, w, h: shapely.box(x, y, x + w, y + h),
    corners, corners, st.floats(1.0, 99.0), st.floats(1.0, 99.0),
)  # fmt: skip
chances = st.builds(
    plan.Chance, stream=st.text(max_size=9), index=st.tuples(st.integers(0, 9))
) | st.builds(lambda seed: plan.state_of(np.random.default_rng(seed)), st.integers(0, 99))
flats = st.builds(
    plan.Flat, area=boxes | st.builds(shapely.MultiPolygon, st.lists(boxes, max_size=2)),
    z=numbers, cover=covers, winter=st.none() | covers, turn=numbers,
)  # fmt: skip
shells = st.builds(
    plan.BuildingPart, outline=boxes, bottom=numbers, height=st.floats(0.0, 900.0),
    facade=st.sampled_from(["facade_brick", "facade_glass"]), tint=colours, cover=covers,
    roof=st.sampled_from(["flat", "dome", "hipped"]), parapet=st.booleans(),
)  # fmt: skip
layers = st.one_of(
    st.builds(plan.GroundCover, kind=st.sampled_from(ObjectClass), pieces=st.tuples(flats)),
    st.builds(plan.Roadway, area=boxes, wear=chances),
    st.builds(
        plan.Buildings, items=st.tuples(st.builds(plan.Building, parts=st.tuples(shells)))
    ),
    st.builds(
        plan.Hills,
        mounds=st.tuples(st.builds(Mound, numbers, numbers, st.floats(1, 99), numbers)),
        flat=boxes, half=st.just((9.0, 9.0)), spacing=st.just((1.0, 1.0)), chance=chances,
        covers=st.tuples(covers),
    ),
    st.builds(
        lambda rows: plan.Things(
            kinds=("bench",), kind=np.zeros(len(rows), np.int64),
            pose=np.array(rows, np.float64).reshape(-1, 5),
        ),
        st.lists(st.tuples(numbers, numbers, numbers, numbers, numbers), max_size=3),
    ),
)  # fmt: skip
plans = st.builds(
    plan.MapPlan, name=st.just("x"), title=st.text(max_size=9), seed=st.integers(0, 9),
    size=st.tuples(st.floats(1, 1e4), st.floats(1, 1e4)), layers=st.lists(layers).map(tuple),
    library=st.just((plan.ThingKind(name="bench"),)),
    chances=st.dictionaries(st.text(max_size=5), chances, max_size=2),
    survey=st.none() | st.builds(
        lambda shape: Survey(houses=[House(shape, "house", roof="gabled")]), boxes
    ),
)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(plans)
def test_a_plan_comes_back_from_its_text(tmp_path_factory, made):
    path = tmp_path_factory.getbasetemp() / "random.plan.json"
    write_plan(path, made)
    again = read_plan(path)
    assert text_of(again) == text_of(made)
    assert [type(layer) for layer in again.layers] == [type(layer) for layer in made.layers]


def test_a_chance_goes_on_where_a_generator_is():
    rng = np.random.default_rng(3)
    rng.integers(9, size=3, dtype=np.int32)
    chance = plan.state_of(rng)
    np.testing.assert_array_equal(chance.generator(0).random(9), rng.random(9))


def test_the_builder_has_no_random_numbers_but_those_of_a_chance():
    tree = ast.parse(inspect.getsource(build))
    modules = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    assert "eyas.engine.core.rng" not in modules
    names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert not names & {"random", "default_rng", "Generator", "stream"}
    assert "generator" in names


def test_ground_stands_on_the_floor_of_all_maps():
    assert FLOOR_HEIGHT == plan.Flat(area=shapely.box(0, 0, 1, 1), cover=Material()).z
