"""Pictures of dense traffic from above, with what the simulator knows of each vehicle in them."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.look_alikes import COLOURS, HEIGHT, PITCH
from eyas.benchmark.policies.listener.detector import BODIES, NAMES
from eyas.benchmark.protocols.referring import REFERRING
from eyas.engine.core.rng import stream
from eyas.engine.settings.env import EnvConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.targets.catalogue import MODELS, kind_index, kind_of, models_of
from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_distances
from eyas.engine.targets.grammar.in_view import InView, body_of
from eyas.lanes import exact

Floats = NDArray[np.float32]
Item = TypeVar("Item")

PLACES: Final = tuple(
    Place(name, weather, "SUMO_VEHICLE")
    for name in ("citystreet", "downtown")
    for weather in ("day", "night", "foggy", "snow")
)
"""Where pictures are taken: where the protocol's recordings ship, in all weathers."""

SCENES: Final = 1024  # Pictures of a block
_TOGETHER: Final = 32  # Batch size when drawing
_SEEDS: Final = 2**40  # Range of the seeds, which tests draw below 100,000,000
_TRIED: Final = 4  # Vehicles of which the camera looks at the one with the most others around it
_NEAR: Final = 14.0  # Radius in which others are counted [m]

_ASIDE: Final = 11.0  # Farthest from a vehicle that the camera looks [m]
_HIGHER, _FLATTER = 2.0, 0.03  # Largest change of height [m] and pitch [rad]
_NATURAL: Final = 0.15  # Share of the pictures in which vehicles have the colours of the traffic
_UNIFORM: Final = 0.25  # Share of those in which all have two colours and two bodies
_TOLD: Final = 0.6  # Share of the vehicles that have a colour of the protocol's look-alikes
_CLEAR: Final = 1.3  # A colour has a name if the next one is so many times as far away


class Vehicles(NamedTuple):
    """V vehicles whose middles are in pictures."""

    picture: NDArray[np.int64]  # Which one, shape (V,)
    place: Floats  # Middle of the vehicle, column and row [pixels], shape (V, 2)
    heading: Floats  # Direction in the picture, column and row, of length 1, shape (V, 2)
    colour: NDArray[np.int64]  # Index into `NAMES`; -1: between two, shape (V,)
    body: NDArray[np.int64]  # Index into `BODIES`, shape (V,)
    share: Floats  # Share that is visible, shape (V,)


def chosen(vehicles: Vehicles, mask: NDArray[np.bool_]) -> Vehicles:
    """Return those of a mask, shape (V,)."""
    parts: tuple[NDArray[Any], ...] = vehicles
    return Vehicles(*(part[mask] for part in parts))


class Scenes(NamedTuple):
    """B pictures."""

    picture: NDArray[np.uint8]  # Shape (B, 3, H, W)
    vehicles: Vehicles


def drawn(env: EnvConfig, seed: int, block: int, count: int = SCENES) -> Scenes:
    """Return the pictures of a block; they depend on its number and the seed only."""
    rng = stream(seed, "scenes of words", block)
    pictures: list[NDArray[np.uint8]] = []
    found: list[Vehicles] = []
    for place in PLACES:
        for scenes in _at(place, env, rng, count // len(PLACES)):
            found.append(scenes.vehicles._replace(
                picture=scenes.vehicles.picture + sum(map(len, pictures))
            ))  # fmt: skip
            pictures.append(scenes.picture)
    vehicles = Vehicles(*map(np.concatenate, zip(*found, strict=True)))
    return Scenes(np.concatenate(pictures), vehicles)


def _at(place: Place, env: EnvConfig, rng: np.random.Generator, count: int) -> Iterator[Scenes]:
    """Yield pictures of one place."""
    views = min(_TOGETHER, count)
    config = REFERRING.settings_of(EpisodeSpec(place, 0.0, 0), env)
    simulation = build_simulation(config, each_alone(views))
    simulation.reseed_alone(np.arange(views), rng.integers(2**30, _SEEDS, views))
    simulation.reset()
    for first in range(0, count, views):
        views = min(views, count - first)
        for tracker in range(views):
            _begin(simulation, tracker, rng)
        yield _pictures(simulation, views, env)
    simulation.close()


def _begin(simulation: Simulation, tracker: int, rng: np.random.Generator) -> None:
    """Put a tracker over traffic at some time, and dress what it sees."""
    simulation.sample_time(tracker, rng)
    actors, _ = simulation.actors_around(tracker)
    here = np.flatnonzero(actors.present[0])
    middle = _crowded(here, actors.position[0, :, :2], rng)
    heading = float(actors.yaw[0, middle]) + 0.5 * math.pi * int(rng.integers(4))
    heading += float(rng.uniform(-0.4, 0.4)) * bool(rng.random() < 0.5)
    height = HEIGHT + rng.uniform(-_HIGHER, _HIGHER)
    pitch = PITCH + rng.uniform(-_FLATTER, _FLATTER)
    aside = rng.uniform(-_ASIDE, _ASIDE, 2)
    back = height * exact.tan(0.5 * math.pi - pitch)
    cosine, sine = float(exact.cos(heading)), float(exact.sin(heading))
    east, north, up = actors.position[0, middle].tolist()
    pose = east + aside[0] - back * cosine, north + aside[1] - back * sine, up + height, heading
    for _ in range(2):  # the first one finds out where the target is
        simulation.start_at(np.array([tracker]), np.array([pose]), np.array([pitch]))
    if rng.random() >= _NATURAL:
        _dress(simulation, tracker, simulation.view.in_view(tracker), rng)


def _crowded(here: NDArray[np.int64], place: NDArray[np.float64], rng: np.random.Generator) -> int:
    """Return one of some vehicles, preferably one among others."""
    tried = rng.choice(here, _TRIED)
    near = np.square(place[tried][:, None] - place[here]).sum(axis=-1) < _NEAR * _NEAR
    return int(tried[near.sum(axis=1).argmax()])


def _dress(simulation: Simulation, tracker: int, view: InView, rng: np.random.Generator) -> None:
    """Give all in view colours that have names, and cars bodies."""
    cars = models_of(kind_index("passenger"))
    looks: dict[str, list[int]] = {}
    for model in cars:
        if model < len(MODELS):
            looks.setdefault(body_of(model), []).append(model)
    bodies, every = list(looks), list(COLOUR_NAMES)
    uniform = rng.random() < _UNIFORM
    pair = [(_one(COLOURS, rng), _one(bodies, rng)) for _ in range(2)]
    for actor, model in zip(view.actor.tolist(), view.model.tolist(), strict=True):
        told = rng.random() < _TOLD
        colour, body = _one(COLOURS if told else every, rng), _one(bodies, rng)
        if uniform:
            colour, body = _one(pair, rng)
        own = _one(looks[body], rng) if kind_of(model).name == "passenger" else model
        simulation.dress(tracker, actor, own, COLOUR_NAMES[colour])


def _one(items: Sequence[Item], rng: np.random.Generator) -> Item:
    return items[int(rng.integers(len(items)))]


def _pictures(simulation: Simulation, views: int, env: EnvConfig) -> Scenes:
    """Draw what the first trackers see, and label it."""
    size = env.observation.height, env.observation.width
    picture = Picture.create(views, *size, actors=simulation.actors)
    simulation.draw(np.arange(views, dtype=np.int32), picture)
    assert picture.rgb is not None
    assert picture.actor_pixels is not None
    found = [
        _labels(simulation, tracker, picture.actor_pixels[tracker], size)
        for tracker in range(views)
    ]
    vehicles = Vehicles(*map(np.concatenate, zip(*found, strict=True)))
    return Scenes(np.ascontiguousarray(np.moveaxis(picture.rgb, -1, 1)), vehicles)


def _labels(
    simulation: Simulation, tracker: int, pixels: NDArray[np.int32], size: tuple[int, int]
) -> Vehicles:
    """Return what is in a tracker's picture, by its actors' pixels, visible and all, (A, 2)."""
    view = simulation.view.in_view(tracker)
    known = {body: index for index, body in enumerate(BODIES)}
    body = np.array([known.get(body_of(model), -1) for model in view.model.tolist()], np.int64)
    inside = ((view.place > 0.0) & (view.place < 1.0)).all(axis=1) & (body >= 0)
    yaw = simulation.snapshot.trackers.euler[tracker, 2]
    turned = view.heading - yaw
    heading = np.stack((-exact.sin(turned), -exact.cos(turned)), axis=1)
    away = np.sqrt(colour_distances(view.colour)) + 1e-3
    first, second = np.sort(away, axis=1)[:, :2].T
    colour = np.where(second >= _CLEAR * first, away.argmin(axis=1), -1)
    counted = pixels[view.actor]
    share = counted[:, 0] / np.maximum(counted[:, 1], 1)
    labels = Vehicles(
        np.full(len(body), tracker),
        (view.place * size[::-1]).astype(np.float32),
        heading.astype(np.float32),
        colour,
        body,
        share.astype(np.float32),
    )
    return chosen(labels, inside)


assert tuple(COLOUR_NAMES) == NAMES
