"""Targets in words: "a red SUV", "a pedestrian in a blue coat".

Each has a few phrases, the shortest first: vehicles their colour and class, then colour and body,
then also the make; people what they wear, then also the rest of their looks; robots what they are,
then also their name. `eyas.targets.telling` chooses one that nothing else in view shares.
"""

import math
from collections.abc import Sequence

from eyas.targets.catalogue import MODELS, kind_of
from eyas.targets.colour_names import colour_name
from eyas.targets.config import TargetName
from eyas.targets.jointed.models import JointedModel
from eyas.targets.jointed.people.people import PEOPLE
from eyas.targets.jointed.people.person import Garment, Hair, Person
from eyas.targets.kind import Colour
from eyas.targets.vehicles.models import VehicleModel

__all__ = [
    "looks_in_words",
    "motion_in_words",
    "phrases",
    "typical_motion",
    "with_article",
    "words_of",
]

_VEHICLES = {
    "BmwX5Simple": ("{} car", "{} SUV", "{} BMW X5 SUV"),
    "CitroenCZeroSimple": ("{} car", "small {} car", "small {} Citroen C-Zero"),
    "ToyotaPriusSimple": ("{} car", "{} hatchback", "{} Toyota Prius hatchback"),
    "LincolnMKZSimple": ("{} car", "{} sedan", "{} Lincoln MKZ sedan"),
    "RangeRoverSportSVRSimple": (
        "{} car", "{} SUV", "{} SUV with a black roof", "{} Range Rover Sport SUV"
    ),
    "TeslaModel3Simple": (
        "{} car", "{} sedan", "{} sedan with a glass roof", "{} Tesla Model 3 sedan"
    ),
    "MercedesBenzSprinterSimple": ("{} van", "{} Mercedes Sprinter van"),
    "BusSimple": ("{} bus",),
    "TruckSimple": ("{} truck", "{} truck without a trailer"),
    "TruckTrailerSimple": ("{} truck", "{} truck with a box trailer"),
    "TruckTankSimple": ("{} truck", "{} truck with a tank trailer"),
    "ScooterSimple": ("{} motorcycle", "{} scooter"),
    "MotorbikeSimple": ("{} motorcycle", "{} motorbike"),
}  # fmt: skip
"""What stands for the colour and the noun, by model. A phrase that is true of two models is a
phrase of both: none that holds for others in view tells a target."""

_ROBOTS: dict[str, str] = {
    TargetName.SHRIMP: "a blue robot rover on six wheels",
    TargetName.CREATE: "a white disc-shaped robot",
    TargetName.SOJOURNER: "a gold robot rover under a solar panel",
    TargetName.MANTIS: "a dark grey walking machine on six legs",
    TargetName.BB_8: "a white and orange robot that rolls on a ball",
    TargetName.AIBO_ERS7: "a white robot puppy with a black face",
    TargetName.BIOLOID_DOG: "a robot dog of black motors and grey brackets",
    TargetName.FIRE_BIRD_6: "a round salmon robot on blue wheels",
    TargetName.SCOUT: "a red and magenta robot walker with a grey head",
    TargetName.GHOST_DOG: "a white robot dog with red feet",
    TargetName.HOAP_2: "a silver humanoid robot with a blue head",
    "Quadrotor": "a grey drone",
}

_GARMENTS = {
    Garment.SHIRT: "shirt",
    Garment.T_SHIRT: "T-shirt",
    Garment.COAT: "coat",
    Garment.JACKET: "jacket",
    Garment.DRESS: "dress",
}

_HEADS = {
    Hair.SHORT: "short {} hair",
    Hair.LONG: "long {} hair",
    Hair.BUN: "a bun of {} hair",
    Hair.CAP: "a {} cap",
    Hair.HAT: "a {} hat",
}

_HAIR = {"beige": "blond"}
"""Colours that have another name on a head."""

_PEOPLE = {person.name: person for person in PEOPLE}


def phrases(model: int, colour: Sequence[float]) -> tuple[str, ...]:
    """Return descriptions of a target, from short to long.

    Args:
        model: Index into `MODELS`.
        colour: Its colour, sRGB 0 to 1.
    """
    if kind_of(model).words:
        return (kind_of(model).words,)
    name, seen = MODELS[model].name, colour_name(colour)
    if name in _PEOPLE:
        return _person(_PEOPLE[name], seen)
    if name in _ROBOTS:
        return (_ROBOTS[name], f"{_ROBOTS[name]} ({name})")
    return tuple(with_article(noun.format(seen)) for noun in _VEHICLES[name])


def words_of(model: int, colour: Sequence[float]) -> str:
    """Return the shortest description of a target."""
    return phrases(model, colour)[0]


def looks_in_words(model: int) -> tuple[str, ...]:
    """Return the names of the colours that a model may have, in the order of its kind's.

    For what always looks the same, such as a robot: what it looks like.
    """
    always = kind_of(model).words or _ROBOTS.get(MODELS[model].name)
    if always:
        return (always,)
    colours: tuple[Colour, ...] = kind_of(model).colours
    return tuple(dict.fromkeys(colour_name(colour) for colour in colours))


def motion_in_words(model: int) -> str:
    """Return how a model usually moves."""
    one = MODELS[model]
    if isinstance(one, JointedModel):
        return f"{one.motion}, {one.speed:g} m/s"
    if isinstance(one, VehicleModel):
        return "drives in traffic, up to 20 m/s"
    return "moves as its settings say" if kind_of(model).words else "flies"


def typical_motion(model: int) -> tuple[float, float]:
    """Return a usual speed [m/s], and the distance after which its motion repeats [m]."""
    one = MODELS[model]
    if isinstance(one, JointedModel):
        return one.speed, one.stride
    if isinstance(one, VehicleModel):
        return 8.0, 2.0 * math.pi * one.wheel_radius
    return (1.0, 4.0 * one.size[0]) if kind_of(model).words else (0.0, 1.0)


def _person(person: Person, colour: str) -> tuple[str, ...]:
    worn = f"a pedestrian in {with_article(f'{colour} {_GARMENTS[person.garment]}')}"
    hair = colour_name(person.hair_colour)
    head = f"with {_HEADS[person.hair].format(_HAIR.get(hair, hair))}"
    if person.garment is Garment.DRESS:
        return worn, f"{worn}, {head}"
    below = f"{worn} and {colour_name(person.trousers)} trousers"
    return worn, below, f"{below}, {head}"


def with_article(noun: str) -> str:
    """Return a noun after its indefinite article."""
    return f"{'an' if noun[0].lower() in 'aeio' else 'a'} {noun}"
