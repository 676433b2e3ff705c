"""A map in a package of the user's own: found, built, driven and drawn without an edit in Eyas."""

import shutil
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from eyas.engine.core.cache.cached import key_of
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.errors import MissingExtraError, UnknownNameError
from eyas.engine.core.identity import program
from eyas.engine.envs.registration import register_map
from eyas.engine.sim import scenes
from eyas.engine.sim.assets import load_assets
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.terrain import ground_at
from eyas.engine.traffic import library
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.network import build_network
from eyas.engine.traffic.record import record
from eyas.engine.traffic.recording_file import save
from eyas.engine.traffic.sumo_install import import_libsumo
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import NETWORK_FILE, TRAFFIC_FILE
from eyas.engine.world.roads.network_file import save_network
from eyas.engine.world.weather import WEATHERS, Season

EXAMPLE = Path(__file__).parents[3] / "examples" / "own_map.py"
NAME = "field_of_a_user:FIELD"
CARS = TrafficConfig(max_vehicles=3)

pytestmark = [pytest.mark.sumo, pytest.mark.usefixtures("shipped")]


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    """The example as a package that ships its roads and its traffic; SUMO is not asked again."""
    try:
        import_libsumo()
    except MissingExtraError as error:
        pytest.skip(str(error))
    folder = tmp_path_factory.mktemp("packages")
    package = folder / NAME.partition(":")[0]
    package.mkdir()
    shutil.copy(EXAMPLE, package / "__init__.py")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        graph = MAPS.get(NAME).roads(0)
        save_network(package / NETWORK_FILE, build_network(graph))
        made = record("field", 0, graph, CARS, library.STANDARD_DURATION, library.CANONICAL_SEED)
        save(made, package / TRAFFIC_FILE)
        for module, name in ((library, "_new"), (scenes, "build_network")):
            patch.setattr(
                module, name, lambda *_, **__: pytest.fail("what is shipped was made anew")
            )
        yield package
    del sys.modules[package.name]


def test_it_is_an_environment_for_each_of_its_weathers():
    register_map(NAME)
    ids = {name for name in gymnasium.registry if name.startswith("eyas/field-")}
    own = set(WEATHERS.built_in) - {"night", "snow"}
    assert ids == {f"eyas/field-{weather}-v0" for weather in own}


@pytest.mark.slow
def test_an_environment_runs_in_it(shipped):
    register_map(NAME)
    env = gymnasium.make("eyas/field-day-v0", config={"traffic": CARS.model_dump()})
    first, _ = env.reset(seed=3)
    again, _ = env.reset(seed=3)
    np.testing.assert_array_equal(first, again)
    assert first.std() > 5.0  # a car on a road in the grass
    for _ in range(10):
        later, _, ended, cut, _ = env.step(env.action_space.sample())
        assert not cut
        assert not ended
    assert (later != first).any()
    with pytest.raises(UnknownNameError, match="on the map 'field'; known: autumn, day"):
        gymnasium.make("eyas/field-day-v0", weather="snow").reset()


def test_its_hill_is_what_the_camera_sees_and_what_the_terrain_says():
    there = load_assets(WorldConfig(map=NAME), CARS, 1)
    spots = [(0.0, 0.0), (30.0, -12.0), (110.0, 0.0)]
    picture = Picture.create(len(spots), 9, 9, depth=True)
    views = Views(
        position=np.array([(*spot, 100.0) for spot in spots]),
        rotation=np.tile([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], (len(spots), 1, 1)),
        world=np.zeros(len(spots), np.int32),
        subject=np.full(len(spots), -1, np.int32),
        field_of_view=0.02,
    )
    there.renderer.draw(views, DrawList.create(1, 1), picture)
    seen = 100.0 - picture.depth[:, 4, 4]
    said = [ground_at(there.scene.terrain, *spot) for spot in spots]
    assert said[0] == pytest.approx(29.9, abs=0.8)  # its summit lies between corners of triangles
    assert seen[:2] == pytest.approx(said[:2], abs=0.3)
    assert seen[2] == pytest.approx(0.0, abs=0.02)  # the road lies on the floor


def test_what_is_made_of_it_is_kept_until_its_source_changes(shipped, monkeypatch):
    made = []

    def keeping(kind, make, inputs, **_):
        made.append((kind, key_of(make, inputs)))
        return make() if kind is EntryKind.PLAN else None

    monkeypatch.setattr(scenes, "cached", keeping)
    found, source = [], shipped / "__init__.py"
    for text in ("", "# another hill\n", "HILL = Mound(0.0, 0.0, 60.0, 7.0)\n"):
        source.write_text(source.read_text() + text)
        exec(text, vars(sys.modules[shipped.name]))  # as in another process
        for module in (program, scenes):
            for what in vars(module).values():
                if hasattr(what, "cache_clear"):
                    what.cache_clear()
        scenes.load_geometry(NAME, 0, Season.SUMMER, (0,))
        scenes.load_solids(NAME, 0, Season.SUMMER)
        found.append(dict(made))
        made.clear()
    for what in vars(scenes).values():
        getattr(what, "cache_clear", lambda: None)()
    assert found[0].keys() == {
        EntryKind.PLAN,
        EntryKind.SCENE,
        EntryKind.GEOMETRY,
        EntryKind.SOLIDS,
    }
    for kind in found[0]:
        assert found[0][kind] == found[1][kind] != found[2][kind]
