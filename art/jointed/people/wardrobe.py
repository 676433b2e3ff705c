"""What a person wears as parts: their shapes, and the colours that are not the garment's."""

from dataclasses import dataclass

from art.jointed.people.carried import carried_shape
from art.jointed.people.heads import hair_shape, head_shape
from art.jointed.people.limbs import (
    SLEEVES,
    THICKNESS,
    Holds,
    forearm,
    shank,
    shoe,
    thigh,
    upper_arm,
)
from art.jointed.people.person import Carried, Head, Lower, Person, Posture
from art.jointed.people.trunks import chest, hips
from art.parts import Shape
from eyas.engine.targets.kind import Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class Dress:
    """The shapes of a person's parts; pairs are left and right."""

    chest: Shape
    hips: Shape | None  # None below a long garment
    head: Shape
    hair: Shape  # Or what covers it
    upper_arms: tuple[Shape, Shape]
    forearms: tuple[Shape, Shape]
    carried: Shape | None
    thighs: tuple[Shape, Shape]
    shanks: tuple[Shape, Shape]
    shoe: Shape


_ANY = (1.0, 1.0, 1.0)
_HOLDS = {
    Posture.PHONE: (Holds.NOTHING, Holds.PHONE),
    Posture.POCKETS: (Holds.POCKET, Holds.POCKET),
}


def dress_of(person: Person) -> Dress:
    """Return the shapes of a person's parts."""
    p = person
    sleeve, thick = SLEEVES[p.garment], THICKNESS[p.build]
    bare_legs = p.lower in (Lower.NONE, Lower.SKIRT)
    below = p.skin if bare_legs else p.lower_colour if p.garment.is_long else None
    # What has skin in the colour of the instance is one part for all skins.
    arm = upper_arm(sleeve, thick, p.cut, p.skin if p.garment.bare_arms else _ANY)
    hands = [
        forearm(sleeve, thick, p.cut, _ANY if p.garment.bare_arms else p.skin, holds)
        for holds in _HOLDS.get(p.posture, (Holds.NOTHING, Holds.NOTHING))
    ]
    thighs = [thigh(p.lower, thick, below, left=left) for left in (True, False)]
    shanks = [shank(p.lower, thick, p.shoes, left=left) for left in (True, False)]
    return Dress(
        chest=chest(p.garment, p.build, p.cut, p.inner_colour),
        hips=None if p.garment.is_long else hips(p.lower, p.build),
        head=head_shape,
        hair=hair_shape(p.head),
        upper_arms=(arm, arm),
        forearms=(hands[0], hands[1]),
        carried=None if p.carried is Carried.NOTHING else carried_shape(p.carried, p.build),
        thighs=(thighs[0], thighs[1]),
        shanks=(shanks[0], shanks[1]),
        shoe=shoe(p.shoes),
    )


def colours_of(person: Person) -> tuple[Colour | None, ...]:
    """Return the colours of the drawn parts in the order of a `Figure`'s; None: the garment's."""
    p = person
    bare_legs = p.lower in (Lower.NONE, Lower.SKIRT, Lower.SHORTS)
    own: list[Colour | None] = [None]
    if not p.garment.is_long:
        own.append(p.lower_colour)
    own.append(p.skin)
    own.append(None if p.head is Head.HOOD else p.hair_colour)
    own += [None, p.skin if p.garment.bare_arms else None] * 2
    if p.carried is not Carried.NOTHING:
        own.append(p.carried_colour)
    thighs = None if p.garment.is_long else p.lower_colour
    leg = [thighs, p.skin if bare_legs else p.lower_colour, p.shoe_colour]
    return (*own, *leg, *leg)
