"""What is painted on roads: lane and stop lines, zebra crossings, arrows."""

from collections.abc import Sequence
from functools import reduce

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.world.build.millimetres import dot, rounded, unit
from eyas.engine.world.roads.areas import Street, joints, streets
from eyas.engine.world.roads.curves import joined
from eyas.lanes import exact
from eyas.maps.plan.plan import Paint
from eyas.maps.roads.painting import RoadPaint, Stripe, stripes

_DASH, _GAP = 3.0, 6.0
_LINE = 0.18  # Width of a lane line: nearly a pixel of a policy's small image, from 22 m away [m]
_CENTRE_LINE = 0.2
_DOUBLE = 0.18  # Distance from the middle of the road to each of two yellow lines [m]
_EDGE_LINE = 0.2
_EDGE = 0.3  # Distance from the kerb to the edge line [m]
_STOP_LINE = 0.4  # Width of a stop line [m]
_ZEBRA_START, _ZEBRA_LENGTH = 0.7, 5.6
"""From the stop line to a crossing, and its extent along the road, as in the original [m]."""
_WALKED = 3.0  # Distance from the stop line to the line on which people cross [m]
_BAR = 0.55  # Width of a bar of a zebra crossing, nearly that of the gap to the next bar [m]

Line = NDArray[np.float64]


def road_paint(network: RoadNetwork, *, centre: str = "white", crossings: bool = True) -> RoadPaint:
    """Return the paint of all roads.

    Args:
        centre: The line between the two directions, `white` or `double yellow`.
        crossings: Whether there are zebra crossings where three or more roads meet.
    """
    meeting, all_streets = joints(network), streets(network)
    both_ways = {(street.end, street.start) for street in all_streets}
    lines: list[Stripe] = []
    zebras: list[list[Stripe]] = []
    for chain in _chains(all_streets, meeting):
        one_way = (chain[0].start, chain[0].end) not in both_ways
        white, yellow = _along(chain, None if one_way else centre)
        lines += white
        zebras += yellow
    arrows: list[shapely.Polygon] = []
    for street in all_streets:
        one_way = (street.start, street.end) not in both_ways
        if meeting[street.end] >= 3:
            leaving = [other for other in all_streets if other.start == street.end]
            lines.append(_stop_line(street))
            arrows += _arrows(street, leaving)
            zebras += [_zebra(street, one_way=one_way)] if crossings else []
        if meeting[street.start] >= 3 and one_way and crossings:
            zebras.append(_zebra(_reversed(street), one_way=True))
    return RoadPaint(lines, arrows, zebras)


def paint_of(network: RoadNetwork, paint: Paint) -> RoadPaint:
    """Return the paint of all roads by the rules of a plan."""
    bars = [[bar] for bar in paint.bars]
    if paint.rule == "none":
        return RoadPaint(list(paint.lines), [], bars)
    made = road_paint(network, centre=paint.centre, crossings=paint.crossings > 0)
    zebras = made.zebras[:: max(paint.crossings, 1)]
    return RoadPaint([*made.lines, *paint.lines], made.arrows, [*zebras, *bars])


def crossings_of(network: RoadNetwork, paint: Paint) -> NDArray[np.float64]:
    """Return where people cross roads on zebras painted by the rule of a plan.

    Returns:
        The right and the left kerb of each, shape (C, 2, 2) [m].
    """
    if paint.rule == "none" or not paint.crossings:
        return np.zeros((0, 2, 2))
    meeting, every = joints(network), streets(network)
    ways = {(street.start, street.end) for street in every}
    made: list[Line | None] = []
    for street in every:
        both = (street.end, street.start) in ways
        if meeting[street.end] >= 3:
            made.append(_walk(street, 2.0 if both else 1.0))
        if meeting[street.start] >= 3 and not both:
            made.append(None)  # painted, but reached from the other side
    kept = [line for line in made[:: paint.crossings] if line is not None]
    return np.array(kept, np.float64).reshape(-1, 2, 2)


def _walk(street: Street, sides: float) -> Line:
    """Return the line from kerb to kerb on which people cross a road beyond its stop line."""
    onwards = street.right[-1] - street.right[-2]
    onwards /= max(float(exact.hypot(*onwards)), 1e-9)
    leftwards = street.inwards(onwards)
    width = float(exact.product(street.left[-1] - street.right[-1], leftwards))
    right = street.right[-1] + _WALKED * onwards
    return np.array([right, right + sides * width * leftwards])


def _along(chain: Sequence[Street], centre: str | None) -> tuple[list[Stripe], list[list[Stripe]]]:
    """Return the white and the yellow lines along joined streets; no centre: one way."""
    middle, *dividers, kerb = (
        reduce(joined, parts) for parts in zip(*(link.lines for link in chain), strict=True)
    )
    path, white, yellow, side = shapely.LineString(middle), [], [], chain[0].side
    if centre is None:
        edge = shapely.offset_curve(path, -side * _EDGE)
        white += stripes(shapely.get_coordinates(edge), _EDGE_LINE)
    elif _comes_first(middle) and centre == "double yellow":
        beside = [shapely.offset_curve(path, side) for side in (-_DOUBLE, _DOUBLE)]
        yellow = [[Stripe(shapely.get_coordinates(line), _LINE) for line in beside]]
    elif _comes_first(middle):
        white += stripes(middle, _CENTRE_LINE)
    for divider in dividers:
        white += stripes(divider, _LINE, (_DASH, _GAP))
    edge = shapely.offset_curve(shapely.LineString(kerb), side * _EDGE)
    return white + stripes(shapely.get_coordinates(edge), _EDGE_LINE), yellow


def _chains(all_streets: list[Street], meeting: dict[str, int]) -> list[list[Street]]:
    """Return streets that are joined by bends, from junction to junction, or all around a ring."""
    next_ = _joined_by_bends(all_streets, meeting)
    follow = set(next_.values())
    starts = [k for k in range(len(all_streets)) if k not in follow]
    chains, done = [], set()
    # What is left when all others are done are rings without a junction.
    for start in [*starts, *range(len(all_streets))]:
        chain = []
        here: int | None = start
        while here is not None and here not in done:
            done.add(here)
            chain.append(all_streets[here])
            here = next_.get(here)
        if chain:
            chains.append(chain)
    return chains


def _joined_by_bends(all_streets: list[Street], meeting: dict[str, int]) -> dict[int, int]:
    """Return which street goes on with the lines of another, by index.

    Lines end where lanes begin or end, and where traffic of one direction meets that of two.
    """
    both = {(street.end, street.start) for street in all_streets}
    leaving: dict[str, list[int]] = {}
    for index, street in enumerate(all_streets):
        leaving.setdefault(street.start, []).append(index)

    def kind(street: Street) -> tuple[int, bool]:
        return len(street.dividers), (street.start, street.end) in both

    found = {}
    for index, street in enumerate(all_streets):
        if meeting[street.end] == 2:
            on = [k for k in leaving.get(street.end, ()) if all_streets[k].end != street.start]
            if len(on) == 1 and kind(all_streets[on[0]]) == kind(street):
                found[index] = on[0]
    return found


def _comes_first(line: Line) -> bool:
    """Return whether this direction of a road is the one that draws the line in the middle."""
    return tuple(line[0]) < tuple(line[-1])


def frame_of(street: Street) -> tuple[Line, Line, Line, float]:
    """Return the right end of the stop line, the directions onwards and left, and the width."""
    onwards = unit(street.right[-1] - street.right[-2])
    leftwards = street.inwards(onwards)
    width = dot(street.left[-1] - street.right[-1], leftwards)
    return street.right[-1], onwards, leftwards, width


def placed(street: Street, outline: ArrayLike) -> Line:
    """Return points given onwards and leftwards from the stop line's right end [m]."""
    origin, onwards, leftwards, _ = frame_of(street)
    return rounded(exact.product(np.asarray(outline), np.stack([onwards, leftwards])) + origin)


def _stop_line(street: Street) -> Stripe:
    onward = -_STOP_LINE / 2
    ends = [(onward, _EDGE), (onward, frame_of(street)[3] - 0.15)]
    return Stripe(placed(street, ends), _STOP_LINE)


def _reversed(street: Street) -> Street:
    """Return a street against its traffic, to mark its start like an end."""
    dividers = tuple(line[::-1] for line in street.dividers[::-1])
    return Street(
        street.end, street.start, street.right[::-1], dividers, street.left[::-1], street.side
    )


def _zebra(street: Street, *, one_way: bool) -> list[Stripe]:
    """Return the bars of the crossing beyond a stop line, over all lanes of the road."""
    road = frame_of(street)[3] * (1 if one_way else 2)
    count = int((road - 0.5) // (2 * _BAR))
    first = (road - (2 * count - 1) * _BAR) / 2 + _BAR / 2
    low, high = _ZEBRA_START, _ZEBRA_START + _ZEBRA_LENGTH
    return [
        Stripe(placed(street, [(low, y), (high, y)]), _BAR)
        for y in first + 2 * _BAR * np.arange(count)
    ]


_TAIL = [(-5.0, -0.08), (-3.2, -0.08), (-3.2, 0.08), (-5.0, 0.08)]
_HEAD = [(-3.4, -0.08), (-2.2, -0.08), (-2.2, -0.3), (-1.0, 0.0), (-2.2, 0.3), (-2.2, 0.08),
         (-3.4, 0.08)]  # fmt: skip
_HOOK = [(-4.2, 0.0), (-3.4, 0.0), (-2.9, 0.55), (-2.65, 0.4), (-2.6, 1.05), (-3.2, 0.95),
         (-3.05, 0.72), (-3.5, 0.16), (-4.2, 0.16)]  # fmt: skip
_ARROW_BACK = 4.0  # From the stop line back to the origin of an arrow, 1 m ahead of its tip [m]


def _arrows(street: Street, leaving: Sequence[Street]) -> list[shapely.Polygon]:
    """Return arrows before the stop line: right from the rightmost lane, left from the leftmost."""
    _, onwards, leftwards, width = frame_of(street)
    turns = [
        unit(other.right[1] - other.right[0]) for other in leaving if other.end != street.start
    ]
    ahead = any(dot(turn, onwards) > 0.7 for turn in turns)
    lanes = len(street.dividers) + 1
    made = []
    for lane in range(lanes):
        parts = [_TAIL, *([_HEAD] if ahead else [])]
        for outermost, side in ((0, -1.0), (lanes - 1, 1.0)):
            if lane == outermost and any(side * dot(turn, leftwards) > 0.7 for turn in turns):
                parts.append([(x, side * y) for x, y in _HOOK])
        if len(parts) > 1:
            arrow = shapely.union_all([shapely.Polygon(part) for part in parts])
            shift = [-_ARROW_BACK, width * (lane + 0.5) / lanes]
            outline = placed(street, shapely.get_coordinates(arrow) + shift)
            made.append(shapely.Polygon(outline))
    return made
