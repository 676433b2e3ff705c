"""Each room says what it is, what it may import, and where to begin."""

import re
from pathlib import Path

import pytest

import eyas

ROOMS = sorted(path.parent for path in Path(eyas.__file__).parent.glob("*/__init__.py"))


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_the_head_of_a_room_says_where_to_begin(room):
    head = (room / "__init__.py").read_text().split('"""')[1]
    assert re.search(r"^May import: \S", head, re.M)
    begin = head[head.index("Begin with") :]
    named = [name for name in re.findall(r"`([\w./]+)`", begin) if name.endswith((".py", ".md"))]
    places = (room, room.parents[2])
    assert named
    assert all(any((place / name).exists() for place in places) for name in named), named
