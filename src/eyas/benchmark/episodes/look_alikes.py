"""Starts for the protocol `referring`: one of several look-alikes, and phrases about it.

Where the target is in view tells nothing: first the camera is put over a crowded place, then the
look-alikes are chosen of all in view, then the target of the look-alikes, each as likely.
"""

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.starts import AROUND_BODY
from eyas.engine.targets.catalogue import MODELS, kind_index, kind_of, models_of
from eyas.engine.targets.colour_names import COLOUR_NAMES
from eyas.engine.targets.grammar.claims import Claim, distinguishes, fits
from eyas.engine.targets.grammar.in_view import CAN_BE_CALLED, BodyWord, InView, body_of
from eyas.engine.targets.grammar.naming import (
    NO_PHRASE,
    Phrase,
    PhraseKind,
    claims_about,
    contradictory,
)
from eyas.engine.targets.grammar.wording import Wording, in_words
from eyas.lanes import exact

HEIGHT: Final = 45.0
"""Height of the drone above the road [m]: it then sees 38 x 28 m. From the 22 m of the other
protocols it would hardly ever see four vehicles, and cars of 4.5 m are still 10 of 84 pixels
long."""

PITCH: Final = 1.37
"""Pitch of the camera, as in the other protocols [rad]: buildings soon block a flatter view."""

CASES: Final = (
    (PhraseKind.COLOUR, 1),
    (PhraseKind.PLACE, 3),
    (PhraseKind.BODY, 7),
    (PhraseKind.ACTION, 1),
    (PhraseKind.RELATION, 3),
    (PhraseKind.COLOUR, 7),
    (PhraseKind.PLACE, 1),
    (PhraseKind.BODY, 3),
    (PhraseKind.ACTION, 3),
    (PhraseKind.RELATION, 1),
    (PhraseKind.COLOUR, 3),
    (PhraseKind.PLACE, 7),
    (PhraseKind.BODY, 1),
)
"""What tells targets apart, and from how many look-alikes, for seeds in a row (order: the episodes
of published figures depend on it). Of eight alike, hardly ever one alone does something, or is
beside something."""

COLOURS: Final = (
    "red",
    "green",
    "orange",
    "purple",
    "sky blue",
    "pink",
    "light green",
    "magenta",
    "teal",
)
"""Colours of look-alikes. None is that of a car in the car parks, which is scenery: phrases do not
know it, but a reader sees it. From above all differ from roads, and from dark glass and roofs."""

_BYSTANDERS: Final = ("yellow", "blue", "white", "grey")  # Further colours of all others

_TOLD_FROM_ABOVE: Final = (BodyWord.SMALL_CAR, BodyWord.VAN)
"""Bodies of cars that their lengths tell from others; that of an SUV is a sedan's."""

_CROWDED: Final = 14.0
"""Radius around the middle of the first picture in which enough vehicles are looked for [m]."""

_INSIDE: Final = 0.08
"""Least distance of look-alikes from the edges of the first picture [its width, its height]."""

_ATTEMPTS: Final = 60  # Times that are tried

_LATER: Final = (250, 500)
"""Physics steps after which what a target does must still tell it apart: one picture does not show
it. 0.5 and 1 s."""


class StagedStart(NamedTuple):
    """A start, and what may be said of it."""

    case: tuple[PhraseKind, int]  # What tells the target apart; number of look-alikes
    actor: int  # The target
    other: int  # The look-alike that the words are about in the variant `other`
    pose: NDArray[np.float64]  # Pose of the drone: east, north, up [m], heading [rad], (4,)
    phrases: dict[str, Phrase]  # What is said in each variant


def case_of(seed: int) -> tuple[PhraseKind, int]:
    """Return the kind of phrase and the number of look-alikes in the episode of a seed."""
    return CASES[seed % len(CASES)]


def staged_start(simulation: Simulation, tracker: int, seed: int) -> StagedStart | None:
    """Put a tracker over look-alikes, choose its target, and find phrases.

    Args:
        simulation: Its simulation, in which the tracker has a world of its own and begins.

    Returns:
        None if there is nothing to refer to at any of the times that are tried: too few vehicles,
        or none that the kind of phrase tells apart.
    """
    rng = stream(seed, "look-alikes")
    for _ in range(_ATTEMPTS):
        simulation.sample_time(tracker, rng)
        found = _staged(simulation, tracker, case_of(seed), rng)
        if found is not None:
            return found
    return None


def repeat_start(simulation: Simulation, tracker: int, source: int, start: StagedStart) -> None:
    """Give a tracker the start of another one."""
    simulation.copy_world(tracker, source)
    _begin_at(simulation, tracker, start.pose)


def _staged(
    simulation: Simulation, tracker: int, case: tuple[PhraseKind, int], rng: np.random.Generator
) -> StagedStart | None:
    """Stage a start at the present time, see `staged_start`."""
    kind, count = case
    pose = _crowded_pose(simulation, tracker, count + 1, rng)
    if pose is None:
        return None
    _begin_at(simulation, tracker, pose)
    view = simulation.view.in_view(tracker)
    alike = _choose(view, kind, count + 1, rng)
    if alike is None:
        return None
    _dress(simulation, tracker, view, alike, kind, rng)
    view = simulation.view.in_view(tracker)  # models have sizes of their own
    members = [int(np.flatnonzero(view.actor == actor)[0]) for actor in alike]
    first = members[:1] if kind in (PhraseKind.COLOUR, PhraseKind.BODY) else members
    for row in first:
        right = _right(simulation, tracker, view, row, case, rng)
        other = None if right is None else _other(view, row, members, kind, rng)
        if right is None or other is None:
            continue
        assert right.claim is not None
        wrong = contradictory(right.claim, view, rng)
        if wrong is None:
            continue
        simulation.follow(tracker, int(view.actor[row]))
        _begin_at(simulation, tracker, pose)
        phrases = {
            "right": right,
            "other": other[1],
            "contradictory": Phrase(in_words(wrong, Wording.TEST, rng), wrong, kind),
            "none": NO_PHRASE,
        }
        actor, named = int(view.actor[row]), int(view.actor[other[0]])
        return StagedStart(case, actor, named, pose, phrases)
    return None


def _crowded_pose(
    simulation: Simulation, tracker: int, count: int, rng: np.random.Generator
) -> NDArray[np.float64] | None:
    """Return a pose of the drone over a place with so many vehicles: east, north, up, heading;
    None: there is no such place, or the pose is inside something.
    """
    actors, _ = simulation.actors_around(tracker)
    here = np.flatnonzero(actors.present[0])
    place = actors.position[0, here, :2]
    near = np.square(place[:, None] - place).sum(axis=2) < _CROWDED * _CROWDED
    crowded = np.flatnonzero(near.sum(axis=1) >= count)
    if not len(crowded):
        return None
    middle = here[int(rng.choice(crowded))]
    shift = rng.uniform(-4.0, 4.0, 2)
    heading = float(actors.yaw[0, middle]) + 0.5 * math.pi * int(rng.integers(4))
    back = HEIGHT * exact.tan(0.5 * math.pi - PITCH)
    east, north, up = actors.position[0, middle].tolist()
    (cosine,), (sine,) = (f(np.array([heading])) for f in (exact.cos, exact.sin))
    east, north = east + shift[0] - back * cosine, north + shift[1] - back * sine
    pose = np.array([east, north, up + HEIGHT, heading])
    free = simulation.clearance.lifted(pose[None, :3], AROUND_BODY)[0]
    return pose if free == pose[2] else None


def _begin_at(simulation: Simulation, tracker: int, pose: NDArray[np.float64]) -> None:
    """Begin the episode of a tracker at a pose."""
    for _ in range(2):  # the first one finds out where a new target is
        simulation.start_at(np.array([tracker]), pose[None], np.array([PITCH]))


def _choose(
    view: InView, kind: PhraseKind, count: int, rng: np.random.Generator
) -> list[int] | None:
    """Return the actors that are to look alike, the target of some kinds first.

    None if there are too few.
    """
    inside = ((view.place > _INSIDE) & (view.place < 1.0 - _INSIDE)).all(axis=1)
    cars = np.array([_is_car(model) for model in view.model.tolist()], bool)
    if kind is not PhraseKind.BODY:  # then they must be able to have the same body
        inside &= cars
    rows = np.flatnonzero(inside)
    if len(rows) < count:
        return None
    return [int(actor) for actor in view.actor[rng.permutation(rows)[:count]]]


def _is_car(model: int) -> bool:
    return kind_of(model).name == "passenger"


def _dress(
    simulation: Simulation,
    tracker: int,
    view: InView,
    alike: Sequence[int],
    kind: PhraseKind,
    rng: np.random.Generator,
) -> None:
    """Make some in view look alike but for what the phrase tells, and all others differ."""
    colours = [COLOURS[k] for k in rng.permutation(len(COLOURS)).tolist()]
    bodies = [word for word in BodyWord if _models_called(word)]
    among = _TOLD_FROM_ABOVE if kind is PhraseKind.BODY else bodies
    own = among[int(rng.integers(len(among)))]
    rest = [word for word in bodies if word not in CAN_BE_CALLED[own]]
    models = dict(zip(view.actor.tolist(), view.model.tolist(), strict=True))
    if kind is PhraseKind.BODY and not _is_car(models[alike[0]]):
        rest = bodies
    shared = _one(_models_called(own), rng)
    used = len(alike) if kind is PhraseKind.COLOUR else 1
    left = (*colours[used:], *_BYSTANDERS)
    for actor, model in models.items():
        if actor not in alike:
            colour, look = left[int(rng.integers(len(left)))], _one_called(rest, rng)
        elif kind is PhraseKind.COLOUR:
            colour, look = colours[alike.index(actor)], shared
        elif kind is PhraseKind.BODY and actor != alike[0]:
            colour, look = colours[0], _one_called(rest, rng)
        else:
            colour, look = colours[0], shared
        simulation.dress(tracker, actor, look if _is_car(model) else model, COLOUR_NAMES[colour])


def _models_called(body: BodyWord) -> list[int]:
    """Return the models of passenger cars that a word is the own one of."""
    cars = models_of(kind_index("passenger"))
    return [model for model in cars if model < len(MODELS) and body_of(model) is body]


def _one_called(bodies: Sequence[BodyWord], rng: np.random.Generator) -> int:
    return _one(_models_called(bodies[int(rng.integers(len(bodies)))]), rng)


def _one(models: Sequence[int], rng: np.random.Generator) -> int:
    return models[int(rng.integers(len(models)))]


def _right(
    simulation: Simulation,
    tracker: int,
    view: InView,
    row: int,
    case: tuple[PhraseKind, int],
    rng: np.random.Generator,
) -> Phrase | None:
    """Return a phrase of a kind about one in view, if exactly so many others share its base."""
    kind, count = case
    own = body_of(int(view.model[row]))
    for claim in claims_about(view, row, kind, rng):
        if claim.body is not own or claim.colour is None or not distinguishes(claim, view, row):
            continue
        match kind:
            case PhraseKind.COLOUR:
                base = Claim(claim.body)
            case PhraseKind.BODY:
                base = Claim(BodyWord.VEHICLE, claim.colour)
            case _:
                base = Claim(claim.body, claim.colour)
        if int(fits(base, view).sum()) != count + 1:
            continue
        if kind is PhraseKind.ACTION and not _lasts(simulation, tracker, claim, view.actor[row]):
            continue
        return Phrase(in_words(claim, Wording.TEST, rng), claim, kind)
    return None


def _lasts(simulation: Simulation, tracker: int, claim: Claim, actor: int) -> bool:
    """Return whether a claim still fits an actor alone a little later."""
    for later in _LATER:
        view = simulation.view.in_view(tracker, later)
        if view.actor[fits(claim, view)].tolist() != [actor]:
            return False
    return True


def _other(
    view: InView, row: int, members: Sequence[int], kind: PhraseKind, rng: np.random.Generator
) -> tuple[int, Phrase] | None:
    """Return another of the look-alikes, and a phrase about it, if possible of the same kind."""
    others = [member for member in members if member != row]
    for own in (kind, *PhraseKind):
        for k in rng.permutation(len(others)).tolist():
            for claim in claims_about(view, others[k], own, rng):
                if claim.colour is not None and distinguishes(claim, view, others[k]):
                    return others[k], Phrase(in_words(claim, Wording.TEST, rng), claim, own)
    return None
