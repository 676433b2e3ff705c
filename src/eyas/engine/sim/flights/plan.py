"""Plans the flight of an episode: sketches several, makes each flyable, and takes the best.

The traffic is recorded, so where the target will be is known, and a flight is planned as a whole
before it is flown. A sketch becomes a flight in this order: it is bent towards the target where
something high stands in its way, smoothed, lifted over what is left, and aimed. Lifts and bends
are smoothed in a way that keeps them no less than what is needed.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.variation import Variation, sample
from eyas.engine.sim.flights.gaze import (
    STEEPEST,
    Aside,
    Glances,
    aimed,
    glances,
    held,
    turned_aside,
)
from eyas.engine.sim.flights.path import CameraPath, FlightScene, FlightSketch
from eyas.engine.sim.flights.shares import SMALL, Asked, FrameShares, foreseen
from eyas.engine.sim.flights.signals import STEP, averaged, highest, rates_of
from eyas.engine.task.clearance import Clearance, Margin

Floats = NDArray[np.float64]


class FlightLimits(NamedTuple):
    """The most that a flight does. Where a limit is not met, it is smoothed once more."""

    acceleration: float  # Of the drone [m/s^2]
    jerk: float  # Of the drone [m/s^3]
    turn: float  # Of the camera, about each axis [rad/s]
    turn_acceleration: float  # [rad/s^2]


LIMITS = FlightLimits(acceleration=8.0, jerk=25.0, turn=2.5, turn_acceleration=10.0)
"""What a camera drone of 1 to 2 kg does without a film that looks wild."""

MARGIN = Margin(aside=1.5, above=1.5, ground=4.5)
"""Higher than buses and trucks; wide enough for what lies between two control points."""

_BENDS = (1.0, 0.7, 0.45, 0.25)
"""Shares of the distance from the target that are tried where something stands in the way."""

_FLATTEST = 0.1
"""Least pitch at which a target is followed; below it the drone would be far away [rad]."""

_STRAIGHT = Aside(side=1.0, margin=0.0, searches=False, sweep=0.0)  # The camera looks past nothing

_LIFT = 2.0  # What is no higher than this is flown over instead of around [m]

_WIDER = 1.5  # Factor on the reach of a smoothing that was not enough

_CANDIDATES, _GOOD = 12, 0.03
"""Most flights that are tried, and the cost below which one is taken at once."""

_FOR_HIDDEN = 4
"""How many times as many are tried for a share of hidden frames, which only chance brings."""

_CORRECTION = 0.7  # Share of an error that the next flight makes up for


class Wishes(NamedTuple):
    """What the settings ask of flights."""

    path: CameraPath
    height: Variation  # Above the target [m]
    pitch: Variation  # At which the camera looks down at it [rad]
    shares: Asked


class FlightSurroundings(NamedTuple):
    """What is known of an episode before it is flown; M samples `STEP` apart."""

    target: Floats  # Middle of the target's body [m], shape (M, 3)
    heading: Floats  # [rad], shape (M,)
    ground: Floats  # z of the ground below it [m], shape (M,)
    size: Floats  # Length, width, height of the target [m], shape (3,)
    field_of_view: float  # Horizontal [rad]
    picture: tuple[int, int]  # Width and height [pixels]
    clearance: Clearance
    others: tuple[Floats, ...] = ()
    """Where other drones of the world will be meanwhile [m], shape (M, 3) each."""
    unseen: int = 0  # Samples before the first picture


class FlightPlan(NamedTuple):
    """A flight."""

    points: Floats
    """Control points: x, y, z [m], yaw, pitch positive down, field of view [rad], shape (M, 6)."""
    shares: FrameShares  # Foreseen
    cost: float  # How far it is from what was asked; 0 is perfect


class _Aimed(NamedTuple):
    """Shares of the time that a sketch is given, so that those asked for come out."""

    cut: float
    away: float
    small: float | None

    def corrected(self, reached: FrameShares, asked: Asked) -> "_Aimed":
        """Return what the next sketch is given."""

        def next_of(given: float, more: float) -> float:
            return min(max(given + _CORRECTION * more, 0.0), 0.98)

        cut, away, small = self
        if asked.cut:
            cut = next_of(cut, asked.cut - reached.cut)
        if asked.in_view is not None:
            away = next_of(away, reached.in_view - asked.in_view)
        if small is not None and asked.small is not None:
            small = next_of(small, asked.small - reached.small)
        return _Aimed(cut, away, small)


def plan_flight(
    around: FlightSurroundings,  # The episode
    wishes: Wishes,  # What is asked
    rng: np.random.Generator,  # Samples everything
) -> FlightPlan:
    """Return the best of some flights that are sampled at random."""
    path, asked = wishes.path, wishes.shares
    in_view = path.in_view if asked.in_view is None else asked.in_view
    # What is asked for is not what is reached: while the camera turns, the target is neither here
    # nor there. Each flight corrects by what the last one has reached.
    aside = _Aimed(asked.cut or 0.0, 1.0 - in_view, asked.small)
    best: FlightPlan | None = None
    for _ in range(_CANDIDATES * (1 if asked.hidden is None else _FOR_HIDDEN)):
        plan = _candidate(around, wishes, aside, rng)
        if plan is None:
            continue
        if best is None or plan.cost < best.cost:
            best = plan
        if best.cost < _GOOD:
            break
        aside = aside.corrected(plan.shares, asked._replace(in_view=in_view))
    return best or _above(around, wishes, rng)


def _candidate(
    around: FlightSurroundings, wishes: Wishes, aside: _Aimed, rng: np.random.Generator
) -> FlightPlan | None:
    """Return a flight; None if it cannot be flown."""
    path = wishes.path
    scene = _scene(around, wishes, rng)
    sketch = path.sketch(scene, rng)
    seen = max(len(scene.time) - around.unseen, 1)
    when = glances(seen, aside.cut, aside.away, rng, away_first=path.searches)
    when = when.after(len(scene.time) - seen)
    how = Aside(
        side=float(rng.choice([-1.0, 1.0])),
        margin=float(rng.uniform(0.4, 0.8)),
        searches=path.searches,
        sweep=float(rng.uniform(1.0, 1.6)),
    )
    if aside.small is not None:
        sketch = sketch._replace(place=_sized(sketch, scene, around, aside.small, rng))
    place = _flyable(sketch.place, scene.target, around.clearance)
    if place is None:
        return None
    return _aimed(place, sketch, (scene, around), (when, how), wishes)


def _scene(around: FlightSurroundings, wishes: Wishes, rng: np.random.Generator) -> FlightScene:
    return FlightScene(
        time=STEP * np.arange(len(around.target), dtype=np.float64),
        target=averaged(around.target, 0.4, steady=True),
        heading=averaged(around.heading, 0.8, steady=True),
        height=sample(wishes.height, rng),
        pitch=min(max(sample(wishes.pitch, rng), _FLATTEST), STEEPEST),
        field_of_view=around.field_of_view,
        ground=around.ground,
    )


def _sized(
    sketch: FlightSketch,
    scene: FlightScene,
    around: FlightSurroundings,
    share: float,
    rng: np.random.Generator,
) -> Floats:
    """Return places so near, and for a share of the time so far, that the target is small then."""
    off = sketch.place - scene.target
    far = np.linalg.norm(off, axis=1)
    # The pixels of a box of the target's mean side, seen from there.
    length, width, height = around.size.tolist()
    area = math.sqrt(length * width * length * height)
    per_metre = 0.5 * around.picture[0] / np.maximum(0.5 * sketch.field_of_view, 0.02)
    pixels = area * np.square(per_metre / np.maximum(far, 1.0))
    when = glances(len(far), 0.0, share, rng, away_first=False).away
    scale = np.where(
        when > 0.0,
        np.maximum(np.sqrt(pixels / (0.5 * SMALL)), 1.0),
        np.minimum(np.sqrt(pixels / (2.0 * SMALL)), 1.0),
    )
    least = 6.0 / np.maximum(far, 6.0)
    return scene.target + off * averaged(np.clip(scale, least, 4.0), 1.5)[:, None]


def _flyable(place: Floats, target: Floats, clearance: Clearance) -> Floats | None:
    """Return a smooth way near a sketched one that touches nothing; None if none is found."""
    flat = _bent(place, target, clearance)
    flat = _smoothed(flat[:, :2], 0.4)
    z = averaged(place[:, 2], 0.5, steady=True)
    reach = 0.9
    for _ in range(8):
        lift, way = np.zeros(len(z)), np.column_stack([flat, z])
        for _ in range(4):
            needed = clearance.lifted(way, MARGIN) - z
            if bool((needed <= lift + 1e-9).all()):
                break
            lift = averaged(highest(np.maximum(needed, lift), reach), reach)
            way = np.column_stack([flat, z + lift])
        if _is_smooth(way):
            free = clearance.lifted(way, Margin(1.0, 1.0, MARGIN.ground - 0.5))
            return way if bool((free <= way[:, 2]).all()) else None
        reach *= _WIDER
        z = averaged(z, 0.5 * reach, steady=True)
    return None


def _bent(place: Floats, target: Floats, clearance: Clearance) -> Floats:
    """Return places nearer to the target where something high stands in the way."""
    off, tried = place - target, []
    for share in _BENDS:
        near = target + off * [share, share, 1.0]
        tried.append(clearance.lifted(near, MARGIN) - near[:, 2])
    lifts = np.array(tried)
    fine = lifts <= _LIFT
    chosen = np.where(fine.any(axis=0), fine.argmax(axis=0), lifts.argmin(axis=0))
    kept = averaged(-highest(-np.array(_BENDS)[chosen], 1.2), 1.2)
    bent: Floats = target + off * np.column_stack([kept, kept, np.ones(len(kept))])
    return bent


def _smoothed(flat: Floats, seconds: float) -> Floats:
    smooth = averaged(flat, seconds, steady=True)
    for _ in range(8):
        if _is_smooth(smooth):
            break
        seconds *= _WIDER
        smooth = averaged(flat, seconds, steady=True)
    return smooth


def _is_smooth(way: Floats) -> bool:
    rates = rates_of(way)
    return rates.second <= LIMITS.acceleration and rates.third <= LIMITS.jerk


def _aimed(
    place: Floats,
    sketch: FlightSketch,
    about: tuple[FlightScene, FlightSurroundings],
    aside: tuple[Glances, Aside],
    wishes: Wishes,
) -> FlightPlan:
    """Return the flight along a way, with its camera aimed."""
    (scene, around), (when, how) = about, aside
    kept = held(when)[:, None]
    look = sketch.look + kept * (scene.target - sketch.look)
    lens = averaged(sketch.field_of_view, 0.3)
    aspect = around.picture[1] / around.picture[0]
    view = turned_aside(aimed(place, look), lens, aspect, when, how)
    turns, seconds = np.column_stack(view), 0.2
    smooth = averaged(turns, seconds, steady=True)
    for _ in range(8):
        rates = rates_of(smooth)
        if rates.first <= LIMITS.turn and rates.second <= LIMITS.turn_acceleration:
            break
        seconds *= _WIDER
        smooth = averaged(turns, seconds, steady=True)
    flight = np.column_stack([place, smooth, lens])
    shares = foreseen(flight, scene, around.size, around.picture, around.clearance, around.unseen)
    return FlightPlan(flight, shares, _cost(flight, shares, around, wishes))


def _cost(flight: Floats, shares: FrameShares, around: FlightSurroundings, wishes: Wishes) -> float:
    """Return how far a flight is from what was asked."""
    asked = wishes.shares
    in_view = wishes.path.in_view if asked.in_view is None else asked.in_view
    cost = abs(shares.in_view - in_view)
    for wanted, got in ((asked.cut, shares.cut), (asked.small, shares.small)):
        cost += 0.0 if wanted is None else abs(got - wanted)
    if asked.hidden is not None:
        cost += abs(shares.hidden - asked.hidden)
    else:  # a film behind houses is of no use to those who did not ask for it
        cost += max(shares.hidden - 0.1, 0.0)
    for other in around.others:
        away = np.linalg.norm(other - flight[:, :3], axis=1)
        cost += 10.0 * float(away.min() < 3.0)
    return cost


def _above(around: FlightSurroundings, wishes: Wishes, rng: np.random.Generator) -> FlightPlan:
    """Return the flight that is left when all others fail: high above the target, at one height."""
    scene = _scene(around, wishes, rng)
    flat = _smoothed(scene.target[:, :2], 0.4)
    height = float(scene.target[:, 2].max()) + max(scene.height, 10.0)
    way = np.column_stack([flat, np.full(len(flat), height)])
    for _ in range(16):
        free = float(around.clearance.lifted(way, MARGIN).max())
        if free <= height:
            break
        height, way[:, 2] = free, free
    sketch = FlightSketch(way, scene.target, np.full(len(flat), scene.field_of_view))
    nothing = glances(len(flat), 0.0, 0.0, rng, away_first=False)
    return _aimed(way, sketch, (scene, around), (nothing, _STRAIGHT), wishes)
