"""The build's id: which rooms make what happens, and which only show or record it."""

from pathlib import Path

import eyas
from eyas.engine.core.identity.build import WORLD, Build

ENGINE = Path(eyas.__file__).parent / "engine"

ASIDE = {"envs", "exports", "overlay", "policies", "recordings", "settings", "terminal", "video"}
"""Rooms that change nothing of an episode: they ask for it, show it, or write it down."""


def test_every_room_of_the_engine_that_makes_episodes_is_of_the_world():
    rooms = {path.parent.name for path in ENGINE.glob("*/__init__.py")}
    assert {f"engine/{room}" for room in rooms - ASIDE} | {"lanes", "maps"} == WORLD


def test_builds_differ_by_rooms_and_say_which():
    rooms = dict.fromkeys(sorted(WORLD | {"engine/video", "benchmark"}), "0")
    one = Build(rooms=rooms, libraries={"torch": "1"})
    for room in rooms:
        other = Build(rooms={**rooms, room: "1"}, libraries={"torch": "1"})
        assert (other.id != one.id, other.world != one.world) == (True, room in WORLD)
        assert one.difference(other) == room
        assert one.difference(other, without=[room.partition("/")[0]]) == ""
    newer = Build(rooms=rooms, libraries={"torch": "2"})
    assert (one.difference(newer), newer.id) == ("", one.id)
    assert one.difference(newer, libraries=True) == "torch 1 and 2"
