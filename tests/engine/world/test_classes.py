"""What stands on a map has the class that a detector would give it."""

import numpy as np
import pytest

from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.mesh import Surface
from eyas.engine.state.scene import LABELLED, ObjectClass
from eyas.engine.world.maps import MAPS
from eyas.maps.things.kinds import THINGS

NAMED = {
    "parked car": ObjectClass.CAR,
    "parked taxi": ObjectClass.CAR,
    "bicycle rack": ObjectClass.BICYCLE,
    "boat": ObjectClass.BOAT,
    "railway car": ObjectClass.TRAIN,
}
"""Everything that stands on maps and looks like what moves; nothing else is labelled."""


def test_kinds_of_things_that_look_like_movers_have_their_class():
    for name, thing in THINGS.items():
        assert NAMED.get(name, thing.kind) == thing.kind, name
        assert (thing.kind in LABELLED) == (name in NAMED), name


@pytest.mark.parametrize("name", [name for name in MAPS.built_in if "simpleway" not in name])
def test_no_copy_on_a_map_looks_like_what_it_is_not(name):
    scene = load_scene(name)
    fixtures = scene.fixtures
    for number, (kind, levels) in enumerate(zip(fixtures.names, fixtures.levels, strict=True)):
        copies = fixtures.object_id[fixtures.prototype == number]
        classes = {ObjectClass(each) for each in scene.object_class[copies].tolist()}
        named = NAMED.get(kind.rstrip(" 0123456789"))
        if named is not None:
            assert classes <= {named}, kind
            continue
        assert not classes & LABELLED, f"{kind}: enter it in NAMED"
        # The bodies of vehicles, and people's skin and clothes, are of this surface.
        surfaces = {material.surface for level in levels for material in level.palette}
        assert Surface.PAINT not in surfaces, f"{kind}: looks like what moves"


def test_the_deck_of_a_flyover_is_road():
    scene = load_scene("citystreet")
    mesh = scene.static
    corners = mesh.positions[mesh.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    level = normal[:, 2] > 0.95 * np.linalg.norm(normal, axis=1)
    high = corners[..., 2].min(axis=1) > scene.terrain.floor + 4.0
    asphalt = np.array([material.texture == "asphalt" for material in mesh.palette])
    deck = level & high & asphalt[mesh.materials]
    assert deck.any()
    middle = corners[deck].mean(axis=1)
    assert set(scene.object_class[scene.static_object[deck]].tolist()) == {ObjectClass.ROAD}
    # Nor has anything that lies on it another class, such as its lines.
    above = level & high & (scene.object_class[scene.static_object] == ObjectClass.STRUCTURE)
    near = np.abs(corners[above].mean(axis=1)[:, None, :] - middle[None]).max(axis=2) < 0.5
    assert not near.any()
