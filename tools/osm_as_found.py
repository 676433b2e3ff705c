"""What makes a file of OpenStreetMap as found: histories, shops, names in all scripts, and defects.

`tools/synthetic_osm.py --as-found` writes it; see there.
"""

import random
import re
from collections.abc import Callable, Iterator

__all__ = ["add_defects", "add_shops", "as_found"]

_NAMES = (
    "Café Zoë", "Кафе «Берёза»", "東京ラーメン", "مطعم النخيل", "Ψητοπωλείο", "서울식당",
    "Łódź & Söhne", 'The "Old" <Inn>', "🍕 Pizza", "ร้านกาแฟ", "बाज़ार", "Ångström'",
)  # fmt: skip
_KINDS = ("shop", "amenity", "office", "tourism", "craft", "leisure")

Node = Callable[..., int]
Line = Callable[..., int]


def add_shops(node: Node, half: tuple[float, float], count: int, rng: random.Random) -> None:
    """Add points with addresses and names, of which the importer needs none."""
    for number in range(count):
        name = rng.choice(_NAMES)
        place = rng.uniform(-half[0], half[0]), rng.uniform(-half[1], half[1])
        node(
            place,
            **{rng.choice(_KINDS): "yes", "name": name, "name__en": f"Shop {number}"},
            addr__street=f"Street {rng.randint(1, 40)}",
            addr__housenumber=f"{rng.randint(1, 200)}{rng.choice(['', 'a', '-7', '½'])}",
            addr__postcode=str(rng.randint(10000, 99999)),
            opening_hours=rng.choice(["Mo-Fr 08:00-18:30; Sa 10:00-16:00; PH off", "24/7"]),
            website=f"https://example.org/{number}",
            level=rng.choice(["0", "-1", "0;1", "3-5", "ground"]),
        )


def add_defects(
    node: Node, way: Line, raw: Callable[[str], None], half: tuple[float, float], rng: random.Random
) -> None:
    """Add what mappers leave behind: broken outlines, lost members, odd numbers."""
    for k in range(40):
        x, y = rng.uniform(-0.9, 0.9) * half[0], rng.uniform(-0.9, 0.9) * half[1]
        ring = [node(at) for at in ((x, y), (x + 14, y), (x + 14, y + 11), (x, y + 11))]
        a, b, c, d = ring
        twin = node((x + 14, y))  # two nodes at one place
        whole = [*ring, a]
        odd = (
            ([a, c, b, d, a], {"building": "yes"}),  # crosses itself
            ([a, b, twin, twin, c, d, a], {"building": "yes", "height": "12,5 m"}),
            (ring, {"building": "house"}),  # open
            ([a, b, 10**9 + k, c, d, a], {"building": "retail"}),  # a node is missing
            ([a], {"building": "yes", "highway": "residential"}),
            (whole, {"building": "yes", "height": "very high", "min_height": "99"}),
            (whole, {"building": "yes", "building__levels": "-3;4"}),
            (whole, {"building": "", "roof__shape": "many", "layer": "one"}),
            ([a, b], {"highway": "elevator", "level": "-1;0;1", "layer": "-1;0;1"}),
            ([a, c], {"highway": "steps", "incline": "up", "layer": "2"}),
            ([a, b], {"highway": "residential", "lanes": "-2", "maxspeed": "walk", "layer": "-1"}),
            ([a, c], {"highway": "corridor", "indoor": "yes", "level": "3"}),
        )
        nodes, tags = odd[k % len(odd)]
        way(nodes, **tags)
        node((x + 5, y + 5), highway="elevator", level="-2;-1;0;1", layer="?")
        member = f'<member type="way" ref="{2 * 10**9 + k}" role="outer"/>'
        outer = way([a, b, c, d, a])
        own = f'<member type="way" ref="{outer}" role="outer"/>'
        itself = f'<member type="relation" ref="{3 * 10**9 + k}" role=""/>'
        members = (member, own + member, own + itself, "", f"{own}{own}")[k % 5]
        raw(
            f'<relation id="{3 * 10**9 + k}">{members}<tag k="type" v="multipolygon"/>'
            '<tag k="building" v="yes"/></relation>'
        )


def as_found(lines: list[str], rng: random.Random) -> Iterator[str]:
    """Yield the lines of a file with the history of each object."""
    for line in lines:
        user = rng.choice(("mapper", "Çelik", "Ольга", "山田太郎", "bot &amp; co"))
        stamp = f"20{rng.randint(10, 25)}-{rng.randint(1, 12):02d}-{rng.randint(1, 28):02d}"
        said = (
            f' version="{rng.randint(1, 30)}" timestamp="{stamp}T12:00:00Z" '
            f'changeset="{rng.randint(10**7, 10**8)}" uid="{rng.randint(1, 10**6)}" '
            f'user="{user}" visible="true"'
        )
        yield re.sub(r"^<(node|way|relation) (id=\"\d+\")", rf"<\1 \2{said}", line)
