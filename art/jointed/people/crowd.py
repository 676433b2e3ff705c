"""Who walks the streets: the original's pedestrian and people made by a grammar from seeds.

Shares of ages, builds, clothes and skin are rough estimates of what European streets show.
"""

from collections.abc import Sequence
from typing import TypeVar

from art.jointed.people.person import Build, Carried, Garment, Head, Lower, Person, Posture, Shoes

LOOKS = 112  # Number of people

Thing = TypeVar("Thing")

_BLACK, _BROWN, _DARK_BROWN, _BLOND, _GREY, _RED, _WHITE_HAIR = (
    (0.08, 0.07, 0.07), (0.28, 0.18, 0.11), (0.17, 0.11, 0.08), (0.72, 0.56, 0.33),
    (0.55, 0.54, 0.53), (0.45, 0.20, 0.10), (0.84, 0.83, 0.81),
)  # fmt: skip
_PALE, _FAIR, _OLIVE_SKIN, _TAN, _DARK, _DEEP = (
    (0.90, 0.72, 0.62), (0.85, 0.66, 0.54), (0.78, 0.58, 0.44), (0.66, 0.46, 0.33),
    (0.48, 0.32, 0.23), (0.32, 0.21, 0.15),
)  # fmt: skip
_JEANS, _DARK_JEANS, _BEIGE, _CHARCOAL, _KHAKI, _NAVY, _PALE_GREY, _WASHED = (
    (0.24, 0.31, 0.46), (0.13, 0.17, 0.29), (0.66, 0.58, 0.45), (0.15, 0.15, 0.17),
    (0.35, 0.35, 0.24), (0.11, 0.14, 0.27), (0.50, 0.51, 0.53), (0.42, 0.50, 0.62),
)  # fmt: skip
_LEATHER, _DARK_SHOE, _WHITE, _SAND, _BLUE_SHOE = (
    (0.30, 0.19, 0.12), (0.10, 0.10, 0.11), (0.85, 0.85, 0.84), (0.62, 0.52, 0.38),
    (0.16, 0.22, 0.38),
)  # fmt: skip

_FIRST = (
    Person(name="Pedestrian", height=1.80, build=Build.MAN, garment=Garment.SHIRT, head=Head.SHORT,
           skin=(0.95, 0.74, 0.66), hair_colour=_BROWN, lower_colour=(0.24, 0.25, 0.50),
           shoe_colour=(0.35, 0.22, 0.13)),
    Person(name="Pedestrian2", height=1.68, build=Build.WOMAN, garment=Garment.COAT, cut="coat",
           head=Head.LONG, skin=_PALE, hair_colour=_BROWN, lower_colour=_CHARCOAL,
           shoe_colour=_DARK_SHOE, shoes=Shoes.BOOTS),
    Person(name="Pedestrian3", height=1.77, build=Build.STOUT, garment=Garment.JACKET, cut="jacket",
           head=Head.SHORT, skin=_DARK, hair_colour=_BLACK, lower_colour=_BEIGE,
           shoe_colour=_LEATHER),
    Person(name="Pedestrian4", height=1.66, build=Build.WOMAN, garment=Garment.DRESS,
           head=Head.LONG, skin=_OLIVE_SKIN, hair_colour=_BLOND, lower=Lower.NONE,
           lower_colour=_OLIVE_SKIN, shoe_colour=_WHITE, carried=Carried.SHOULDER_BAG,
           carried_colour=_LEATHER),
    Person(name="Pedestrian5", height=1.86, build=Build.MAN, garment=Garment.T_SHIRT,
           head=Head.CAP, skin=_FAIR, hair_colour=(0.11, 0.14, 0.30), lower_colour=_JEANS,
           shoes=Shoes.TRAINERS, shoe_colour=_WHITE, carried=Carried.BACKPACK),
    Person(name="Pedestrian6", height=1.70, build=Build.WOMAN, garment=Garment.T_SHIRT,
           head=Head.BUN, skin=_DEEP, hair_colour=_BLACK, lower_colour=_BEIGE,
           shoes=Shoes.TRAINERS, shoe_colour=_WHITE),
    Person(name="Pedestrian7", height=1.74, build=Build.MAN, garment=Garment.COAT, cut="coat",
           head=Head.HAT, skin=_PALE, hair_colour=(0.25, 0.22, 0.19), lower_colour=_CHARCOAL,
           shoe_colour=_LEATHER),
    Person(name="Pedestrian8", height=1.72, build=Build.STOUT, garment=Garment.JACKET, cut="jacket",
           head=Head.SHORT, skin=_TAN, hair_colour=_GREY, lower_colour=_KHAKI,
           shoe_colour=_LEATHER, posture=Posture.STOOPED),
)  # fmt: skip
"""The first is the original's."""

_BUILDS = ((Build.MAN, 40), (Build.WOMAN, 42), (Build.STOUT, 10), (Build.CHILD, 8))
_SKINS = ((_PALE, 30), (_FAIR, 26), (_OLIVE_SKIN, 16), (_TAN, 12), (_DARK, 9), (_DEEP, 7))
_HAIR = ((_DARK_BROWN, 26), (_BROWN, 26), (_BLOND, 16), (_BLACK, 10), (_GREY, 10), (_RED, 4),
         (_WHITE_HAIR, 6))  # fmt: skip
_GARMENTS = {
    Build.MAN: ((Garment.T_SHIRT, 22), (Garment.SHIRT, 18), (Garment.HOODIE, 14),
                (Garment.JACKET, 20), (Garment.OPEN_JACKET, 12), (Garment.DOWN_JACKET, 6),
                (Garment.COAT, 8)),
    Build.WOMAN: ((Garment.T_SHIRT, 20), (Garment.SHIRT, 16), (Garment.HOODIE, 6),
                  (Garment.JACKET, 16), (Garment.OPEN_JACKET, 8), (Garment.DOWN_JACKET, 6),
                  (Garment.COAT, 14), (Garment.DRESS, 14)),
    Build.CHILD: ((Garment.T_SHIRT, 45), (Garment.HOODIE, 25), (Garment.JACKET, 20),
                  (Garment.DOWN_JACKET, 10)),
}  # fmt: skip
_HEADS = {
    Build.MAN: ((Head.SHORT, 62), (Head.BALD, 10), (Head.CAP, 10), (Head.BEANIE, 6), (Head.HAT, 4),
                (Head.TAIL, 2), (Head.BOB, 2)),
    Build.WOMAN: ((Head.LONG, 34), (Head.TAIL, 18), (Head.BOB, 20), (Head.BUN, 10),
                  (Head.SHORT, 8), (Head.BEANIE, 5), (Head.HAT, 3), (Head.CAP, 2)),
    Build.CHILD: ((Head.SHORT, 40), (Head.TAIL, 15), (Head.BOB, 15), (Head.LONG, 10),
                  (Head.CAP, 12), (Head.BEANIE, 8)),
}  # fmt: skip
_LOWERS = {
    Build.MAN: ((Lower.TROUSERS, 72), (Lower.WIDE, 12), (Lower.SHORTS, 16)),
    Build.WOMAN: ((Lower.TROUSERS, 62), (Lower.WIDE, 14), (Lower.SKIRT, 18), (Lower.SHORTS, 6)),
    Build.CHILD: ((Lower.TROUSERS, 65), (Lower.SHORTS, 35)),
}  # fmt: skip
_CUTS = {
    Garment.T_SHIRT: (("plain", 70), ("striped", 30)),
    Garment.SHIRT: (("checked", 45), ("plain", 40), ("striped", 15)),
    Garment.HOODIE: (("plain", 100),),
    Garment.JACKET: (("jacket", 100),),
    Garment.OPEN_JACKET: (("plain", 100),),
    Garment.DOWN_JACKET: (("quilted", 100),),
    Garment.COAT: (("coat", 100),),
    Garment.DRESS: (("plain", 75), ("striped", 25)),
}
_TROUSERS = ((_JEANS, 22), (_DARK_JEANS, 20), (_CHARCOAL, 22), (_BEIGE, 10), (_KHAKI, 7),
             (_NAVY, 7), (_PALE_GREY, 6), (_WASHED, 6))  # fmt: skip
_SHOES = ((Shoes.TRAINERS, 52), (Shoes.LEATHER, 34), (Shoes.BOOTS, 14))
_SHOE_COLOURS = {
    Shoes.TRAINERS: ((_WHITE, 50), (_DARK_SHOE, 25), (_BLUE_SHOE, 15), (_PALE_GREY, 10)),
    Shoes.LEATHER: ((_DARK_SHOE, 50), (_LEATHER, 35), (_SAND, 15)),
    Shoes.BOOTS: ((_DARK_SHOE, 60), (_LEATHER, 40)),
}
_COVERINGS = (
    ((0.10, 0.10, 0.11), 30),
    ((0.11, 0.14, 0.30), 20),
    ((0.45, 0.12, 0.12), 12),
    ((0.30, 0.30, 0.31), 14),
    ((0.66, 0.58, 0.45), 12),
    ((0.88, 0.86, 0.83), 12),
)
_POSTURES = ((Posture.FREE, 68), (Posture.POCKETS, 12), (Posture.PHONE, 8), (Posture.LADEN, 12))
_CARRIED = ((Carried.NOTHING, 56), (Carried.BACKPACK, 22), (Carried.SHOULDER_BAG, 22))
_BAGS = (((0.13, 0.13, 0.14), 36), ((0.11, 0.15, 0.30), 14), ((0.34, 0.21, 0.13), 18),
         ((0.50, 0.13, 0.12), 10), ((0.36, 0.37, 0.38), 12), ((0.62, 0.52, 0.38), 10))  # fmt: skip
_HEIGHTS = {
    Build.MAN: (1.64, 1.94), Build.WOMAN: (1.54, 1.80), Build.STOUT: (1.60, 1.86),
    Build.CHILD: (1.08, 1.46),
}  # fmt: skip
_INNER = ((_WHITE, 60), ((0.20, 0.20, 0.22), 40))
_OVER = (Garment.OPEN_JACKET, Garment.JACKET, Garment.COAT)
_HOODS = 0.3  # Share of hoods that are up
_HAIRY = (Head.SHORT, Head.LONG, Head.BUN, Head.TAIL, Head.BOB, Head.BALD)


class _Dice:
    """Random numbers of one person, by what they decide: another rule changes none of the rest."""

    def __init__(self, number: int) -> None:
        self._number = number

    def share(self, what: str) -> float:
        """Return a number from 0 up to below 1."""
        word = _mixed(self._number * 0x9E3779B1)
        for letter in what.encode():
            word = _mixed(word ^ letter)
        return word / 4294967296.0

    def one(self, what: str, of: Sequence[tuple[Thing, int]]) -> Thing:
        """Return one of some things with weights."""
        left = self.share(what) * sum(weight for _, weight in of)
        for thing, weight in of:
            left -= weight
            if left < 0.0:
                return thing
        return of[-1][0]


def _mixed(word: int) -> int:
    """Return 32 bits that look random, for 32 bits: Wellons' `lowbias32` hash."""
    word &= 0xFFFFFFFF
    word = ((word ^ (word >> 16)) * 0x7FEB352D) & 0xFFFFFFFF
    word = ((word ^ (word >> 15)) * 0x846CA68B) & 0xFFFFFFFF
    return word ^ (word >> 16)


def _person(number: int) -> Person:
    """Return the person of a number, from 9 on."""
    dice = _Dice(number)
    build = dice.one("build", _BUILDS)
    form = Build.MAN if build is Build.STOUT else build  # what is worn
    low, high = _HEIGHTS[build]
    height = low + (high - low) * 0.5 * (dice.share("tall") + dice.share("taller"))
    garment = dice.one("garment", _GARMENTS[form])
    lower = _lower(dice, form, garment)
    head = dice.one("head", _HEADS[form])
    if garment is Garment.HOODIE and dice.share("hood") < _HOODS:
        head = Head.HOOD
    shoes = dice.one("shoes", _SHOES) if build is not Build.CHILD else Shoes.TRAINERS
    posture, carried = _carrying(dice, build, garment)
    tone = dice.one("skin", _SKINS)
    hair_colour = dice.one(
        "hair", _HAIR if tone not in (_TAN, _DARK, _DEEP) else _HAIR[:1] + _HAIR[3:5]
    )
    return Person(
        name=f"Pedestrian{number}",
        height=round(height, 2),
        build=build,
        garment=garment,
        head=head,
        skin=tone,
        hair_colour=hair_colour if head in _HAIRY else dice.one("covering", _COVERINGS),
        lower=lower,
        lower_colour=tone if lower is Lower.NONE else dice.one("trousers", _TROUSERS),
        shoes=shoes,
        shoe_colour=dice.one("shoe", _SHOE_COLOURS[shoes]),
        cut=dice.one("cut", _CUTS[garment]),
        inner_colour=dice.one("inner", _INNER) if garment in _OVER else _WHITE,
        posture=posture,
        carried=carried,
        carried_colour=dice.one("bag", _BAGS),
    )


def _lower(dice: _Dice, form: Build, garment: Garment) -> Lower:
    """Return what the legs are clothed in: short things with light garments only."""
    if garment is Garment.DRESS:
        return Lower.NONE
    lower = dice.one("lower", _LOWERS[form])
    warm = garment in (Garment.JACKET, Garment.DOWN_JACKET, Garment.COAT)
    if (warm and lower is Lower.SHORTS) or (garment is Garment.COAT and lower is Lower.SKIRT):
        return Lower.TROUSERS
    return lower


def _carrying(dice: _Dice, build: Build, garment: Garment) -> tuple[Posture, Carried]:
    """Return a posture and what is carried in it."""
    if build is Build.CHILD:
        return Posture.FREE, dice.one("carried", ((Carried.NOTHING, 60), (Carried.BACKPACK, 40)))
    if dice.share("pram") < 0.05:
        return Posture.PUSHES, Carried.PRAM
    if dice.share("old") < 0.07 and not garment.is_long:
        return Posture.STOOPED, Carried.NOTHING
    posture = dice.one("posture", _POSTURES)
    if posture is Posture.LADEN:
        return posture, Carried.SHOPPING_BAG
    return posture, dice.one("carried", _CARRIED)


PEOPLE: tuple[Person, ...] = (*_FIRST, *(_person(number) for number in range(9, LOOKS + 1)))
"""The first is the original's; all differ in build, clothes, skin, hair or what they carry."""
