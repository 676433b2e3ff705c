"""What a camera has in view, and the target in words that tell it from that."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens, places, principal_point, widest
from eyas.engine.state.motion import ActorState, ActorView
from eyas.engine.state.snapshot import CameraState, Snapshot
from eyas.engine.targets.catalogue import MODELS, extent_of, kind_of
from eyas.engine.targets.grammar.in_view import InView
from eyas.engine.targets.words import ObjectInView, distinguishing_phrase, phrases
from eyas.lanes import exact

Floats = NDArray[np.float64]


class _Look(NamedTuple):
    """The camera of a tracker."""

    position: Floats  # [m], shape (3,)
    axes: Floats  # Camera to world; columns forward, left, up, shape (3, 3)
    wide: float  # Tangent of half the horizontal field of view
    aspect: float  # Height of the picture over its width
    lens: Lens | None  # None: a pinhole

    @classmethod
    def of(cls, cameras: CameraState, tracker: int, aspect: float, lens: Lens | None) -> "_Look":
        """Return the camera of a tracker."""
        wide = float(exact.tan(0.5 * float(cameras.field_of_view[tracker])))
        return cls(cameras.position[tracker], cameras.rotation[tracker], wide, aspect, lens)


def target_in_words(
    shown: Snapshot,  # The state that the picture shows
    around: ActorView,  # The actors around the tracker at that time
    tracker: int,
    aspect: float,  # Height of the camera's picture over its width
    lens: Lens | None = None,  # Its lens; None: a pinhole
) -> str:
    """Return a description of a tracker's target as its camera shows it, such as "a red SUV".

    No other actor of which a part is in the camera's view shares it, hidden or not.
    """
    look, target = _Look.of(shown.cameras, tracker, aspect, lens), shown.targets.actor[tracker]
    actors, _, model, colour = around

    def known(actor: int) -> tuple[str, ...]:
        return phrases(int(model[actor]), colour[actor].tolist())

    own, near = known(target), _near(look, around, target)
    # Who shares no phrase is told apart wherever it is, and mostly nobody does.
    chosen = near[[n == target or not {*own}.isdisjoint(known(n)) for n in near.tolist()]]
    if len(chosen) == 1:
        return own[0]
    inside, corners = _boxes(look, around, chosen)
    # Where the middle is: half across the picture is 0.5, also if it is behind the camera.
    middle = corners.mean(axis=1)
    forward, column = middle[:, 0], _placed(middle, look)[:, 0]

    def seen(row: int) -> ObjectInView:
        actor = chosen[row]
        return ObjectInView(
            model=int(model[actor]),
            colour=colour[actor].tolist(),
            speed=float(actors.speed[0, actor]),
            yaw_rate=float(actors.yaw_rate[0, actor]),
            column=float(column[row]),
            distance=float(forward[row]),
        )

    (row,) = np.flatnonzero(chosen == target).tolist()
    others = np.flatnonzero(inside & (chosen != target)).tolist()
    return distinguishing_phrase(seen(row), [seen(other) for other in others])


def in_view(
    shown: Snapshot,  # The state that the picture shows
    around: ActorView,  # The actors around the tracker at that time
    tracker: int,
    aspect: float,  # Height of the camera's picture over its width
    lens: Lens | None = None,  # Its lens; None: a pinhole
) -> InView:
    """Return the moving objects, and the target, of which a part is in a tracker's view."""
    look, target = _Look.of(shown.cameras, tracker, aspect, lens), shown.targets.actor[tracker]
    chosen = _near(look, around, target)
    inside, corners = _boxes(look, around, chosen)
    inside |= chosen == target
    actor, (actors, _, model, colour) = chosen[inside], around
    heading, ahead = actors.yaw[0, actor], np.array([kind_of(m).ahead for m in model[actor]])
    along = np.stack([exact.cos(heading), exact.sin(heading)], axis=1)
    return InView(
        actor=actor.astype(np.int64),
        model=model[actor].astype(np.int64),
        colour=colour[actor].astype(np.float64),
        speed=actors.speed[0, actor],
        yaw_rate=actors.yaw_rate[0, actor],
        heading=heading,
        middle=actors.position[0, actor, :2] + ahead[:, None] * along,
        size=np.array([MODELS[m].size[:2] for m in model[actor]]).reshape(-1, 2),
        place=_placed(corners[inside].mean(axis=1), look),
    )


def _placed(points: Floats, look: _Look) -> Floats:
    """Return where points, forward, left and up of a camera [m], shape (..., 3), are in its
    picture, in shares of its sides, also if they are behind it.
    """
    forward, left, up = np.moveaxis(points, -1, 0)
    before = np.maximum(forward, 1e-3)
    if look.lens is not None:
        bent = places(look.lens, np.stack([-left, -up, before], axis=-1)) / (2.0 * look.wide)
        column, row = principal_point(look.lens, 1.0, 1.0)
        return np.stack([column + bent[..., 0], row + bent[..., 1] / look.aspect], axis=-1)
    reach = before * look.wide
    return np.stack([0.5 - 0.5 * left / reach, 0.5 - 0.5 * up / (reach * look.aspect)], axis=-1)


def _near(look: _Look, around: ActorView, target: np.integer) -> NDArray[np.int64]:
    """Return the actors that may be in a view, and its target, in order, shape (K,)."""
    seen, high = look.wide, look.wide * look.aspect
    if look.lens is not None:
        seen = high = widest(look.lens, (1.0, look.aspect), (0.5 / seen, 0.5 / seen))
    actors, _, model, _ = around
    middles = _in_camera(actors.position[0], look)
    near = _may_be_in_view(middles, _reach(len(MODELS))[model], seen, high)
    near &= actors.present[0] & ~_flying(len(MODELS))[model]
    near[target] = True
    return near.nonzero()[0]


def _boxes(
    look: _Look, around: ActorView, chosen: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], Floats]:
    """Return whether a part of actors is in a view, shape (K,), and the corners of their boxes
    forward, left and up of its camera [m], shape (K, 8, 3).
    """
    corners = _in_camera(_corners(around.state, chosen, around.model), look)
    return (_in_view if look.lens is None else _in_bent_view)(corners, look), corners


_LIMBS = 2.0
"""Limbs reach less than this out of the box of a model's size, and so do trailers that swing [m].
"""


@cache
def _flying(models: int) -> NDArray[np.bool_]:
    """Return which of so many models fly: phrases speak of what is on the ground."""
    return np.array([model.motion == "flies" for model in MODELS[:models]])


@cache
def _reach(models: int) -> Floats:
    """Return how far any corner of each of so many models may be from its place [m]."""
    return np.array(
        [
            exact.length(model.size) + abs(kind_of(k).ahead)
            for k, model in enumerate(MODELS[:models])
        ]
    )


def _may_be_in_view(middles: Floats, reach: Floats, wide: float, high: float) -> NDArray[np.bool_]:
    """Return whether spheres may be in a view, as `_in_view` does for boxes; most are far aside."""
    forward, left, up = middles.T
    reach = reach + _LIMBS
    across, down = math.sqrt(1.0 + wide * wide) * reach, math.sqrt(1.0 + high * high) * reach
    inside: NDArray[np.bool_] = (
        (forward > -reach)
        & (np.abs(left) - forward * wide < across)
        & (np.abs(up) - forward * high < down)
    )
    return inside


def _corners(actors: ActorState, chosen: NDArray[np.integer], model: NDArray[np.int32]) -> Floats:
    """Return the corners of the boxes of some actors of one world [m], shape (K, 8, 3)."""
    low, high = np.empty((2, len(chosen), 3))
    for row, actor in enumerate(chosen.tolist()):
        low[row], high[row] = _extent(actors, actor, int(model[actor]))
    pick = np.array([[bit >> axis & 1 for axis in range(3)] for bit in range(8)], bool)
    own = np.where(pick, high[:, None], low[:, None])
    yaw, slope = actors.yaw[0, chosen], actors.slope[0, chosen]
    cosine, sine = exact.cos(yaw)[:, None], exact.sin(yaw)[:, None]
    east = cosine * own[..., 0] - sine * own[..., 1]
    north = sine * own[..., 0] + cosine * own[..., 1]
    up = own[..., 2] + own[..., 0] * exact.tan(slope)[:, None]
    corners: Floats = np.stack([east, north, up], axis=-1) + actors.position[0, chosen][:, None]
    return corners


def _extent(actors: ActorState, actor: int, model: int) -> Floats | tuple[list[float], list[float]]:
    """Return the least and largest coordinates of an actor ahead, left and up of its place [m]."""
    travelled, speed = float(actors.travelled[0, actor]), float(actors.speed[0, actor])
    slope, hitch = float(actors.slope[0, actor]), float(actors.hitch[0, actor])
    limbs = extent_of(model, travelled, speed, slope)
    if limbs is not None:
        return limbs
    length, width, height = MODELS[model].size
    middle, half = kind_of(model).ahead, 0.5 * width + 0.5 * length * abs(hitch)  # swings aside
    return [middle - 0.5 * length, -half, 0.0], [middle + 0.5 * length, half, height]


def _in_camera(points: Floats, look: _Look) -> Floats:
    """Return points forward, left and up of a camera [m], shape (..., 3)."""
    shares: Floats = (points - look.position)[..., None] * look.axes
    # One by one: `sum` may add them in another order.
    return shares[..., 0, :] + shares[..., 1, :] + shares[..., 2, :]


def _in_bent_view(corners: Floats, look: _Look) -> NDArray[np.bool_]:
    """Return the same through a lens: whether the boxes around their corners reach the picture."""
    before = corners[..., 0] > 1e-3
    place = _placed(corners, look)
    low = np.where(before[..., None], place, np.inf).min(axis=1)
    high = np.where(before[..., None], place, -np.inf).max(axis=1)
    inside: NDArray[np.bool_] = ((low < 1.0) & (high > 0.0)).all(axis=1)
    return inside


def _in_view(corners: Floats, look: _Look) -> NDArray[np.bool_]:
    """Return whether any part of boxes may be in a view: none is outside of one of its planes."""
    (forward, left, up), wide = np.moveaxis(corners, -1, 0), look.wide
    high = wide * look.aspect
    planes = [forward, forward * wide - left, forward * wide + left]
    planes += [forward * high - up, forward * high + up]
    inside: NDArray[np.bool_] = np.all([(plane > 0.0).any(axis=1) for plane in planes], axis=0)
    return inside
