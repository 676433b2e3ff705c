"""The people of the catalogue: their words and what they are as models."""

from art.jointed.model import JointedModel
from art.jointed.people.crowd import PEOPLE
from art.jointed.people.gait import figure_of
from art.jointed.people.person import Carried, Garment, Head, Lower, Person, Shoes
from art.jointed.people.wardrobe import colours_of, dress_of
from eyas.engine.targets.colour_names import colour_name, with_article
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.habit import Behaviour, Habit
from eyas.engine.targets.kind import Colour

_COLOURS: tuple[Colour, ...] = (
    (0.25, 0.55, 0.20),
    (0.72, 0.12, 0.11),
    (0.13, 0.27, 0.62),
    (0.90, 0.88, 0.84),
    (0.13, 0.13, 0.15),
    (0.88, 0.72, 0.14),
    (0.86, 0.42, 0.12),
    (0.45, 0.20, 0.50),
    (0.55, 0.56, 0.58),
    (0.12, 0.50, 0.52),
    (0.11, 0.15, 0.33),
    (0.28, 0.29, 0.31),
    (0.70, 0.62, 0.50),
    (0.34, 0.23, 0.15),
    (0.41, 0.12, 0.12),
    (0.34, 0.36, 0.21),
)
"""Colours of shirts and coats, sRGB; the first is the original's green. Most people wear muted
ones."""

_HABIT = Habit(Behaviour.POLYLINE, speed=2.0, acceleration=2.0, yaw_rate=2.5, radius=1.0)

_HEADS = {
    Head.SHORT: "short {} hair",
    Head.LONG: "long {} hair",
    Head.BUN: "a bun of {} hair",
    Head.TAIL: "{} ponytail",
    Head.BOB: "a bob of {} hair",
    Head.CAP: "{} cap",
    Head.HAT: "{} hat",
    Head.BEANIE: "{} beanie",
    Head.HOOD: "the hood up",
    Head.BALD: "a bald crown",
}

_SINGLE = (Head.TAIL, Head.CAP, Head.HAT, Head.BEANIE)  # What has an article before it

_HAIR = {"beige": "blond", "ochre": "blond"}  # Colours that have another name on a head


def _words(person: Person) -> tuple[str, ...]:
    """Return what one wears, then also the rest of one's looks."""
    worn = f"a pedestrian in a {{}} {person.garment.value}"
    if person.garment is Garment.OPEN_JACKET:
        worn = "a pedestrian in a {} jacket"
    hair = colour_name(person.hair_colour)
    head = _HEADS[person.head].format(_HAIR.get(hair, hair))
    head = f"with {with_article(head) if person.head in _SINGLE else head}"
    if person.lower is Lower.NONE:
        return worn, f"{worn}, {head}", f"{worn}, {head}{_rest(person)}"
    below = "trousers" if person.lower is Lower.WIDE else person.lower.value
    below = f"{colour_name(person.lower_colour)} {below}"
    clothed = f"{worn} and {with_article(below) if person.lower is Lower.SKIRT else below}"
    return worn, clothed, f"{clothed}, {head}", f"{clothed}, {head}{_rest(person)}"


def _rest(person: Person) -> str:
    """Return what is on the feet and in the hands, as the end of a phrase."""
    shoes = "boots" if person.shoes is Shoes.BOOTS else "shoes"
    said = f" and {colour_name(person.shoe_colour)} {shoes}"
    if person.carried is not Carried.NOTHING:
        thing = f"{colour_name(person.carried_colour)} {person.carried.value}"
        said += (
            f", {'pushing' if person.carried is Carried.PRAM else 'carrying'} {with_article(thing)}"
        )
    return said


def _pedestrian(person: Person) -> JointedModel:
    """Return a pedestrian; the original's is 1.80 m high, its reference point at 1.27 m."""
    figure, name = figure_of(person, dress_of(person)), TargetName.PEDESTRIAN.value
    return JointedModel(
        name=person.name,
        typename=name,
        kind=name,
        size=person.size,
        rise=1.27 / 1.8 * person.height,
        words=_words(person),
        motion=f"walks from point to point, {_HABIT.speed:g} m/s",
        speed=_HABIT.speed,
        stride=figure.period,
        figure=figure,
        habit=_HABIT,
        colours=_COLOURS,
        part_colours=colours_of(person),
    )


PEDESTRIANS: tuple[JointedModel, ...] = tuple(map(_pedestrian, PEOPLE))
"""Their models in the catalogue."""
