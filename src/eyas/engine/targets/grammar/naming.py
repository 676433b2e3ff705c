"""Chooses what is said of a target: a claim that tells it apart, or one that fits nothing."""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_name
from eyas.engine.targets.grammar.attributes import attributes_of
from eyas.engine.targets.grammar.claims import (
    Bearing,
    Claim,
    MotionWord,
    PicturePlace,
    distinguishes,
    fits,
    holds,
    is_painted,
)
from eyas.engine.targets.grammar.in_view import CAN_BE_CALLED, BodyWord, InView, body_of
from eyas.engine.targets.grammar.wording import Wording, in_words

Item = TypeVar("Item")


class PhraseKind(StrEnum):
    """By what a phrase tells a target apart."""

    COLOUR = "colour"
    BODY = "body"
    ACTION = "action"
    PLACE = "place"
    RELATION = "relation"


class Phrase(NamedTuple):
    """A target in words."""

    words: str  # A sentence in small letters; empty: nothing is said
    claim: Claim | None  # What it says; None: nothing
    kind: PhraseKind | None  # None: nothing is said

    @property
    def attributes(self) -> NDArray[np.float32]:
        """What it says as numbers, see `ATTRIBUTES`."""
        return attributes_of(self.claim)


NO_PHRASE: Final = Phrase("", None, None)  # No words


def phrase_about(
    view: InView,  # What is in view
    row: int,  # Which of it the phrase is about
    rng: np.random.Generator,  # Samples what is said, and how
    wording: Wording = Wording.TRAINING,  # Set of wordings
    kinds: Sequence[PhraseKind] = tuple(PhraseKind),  # Kinds that are allowed
) -> Phrase:
    """Return a sampled phrase that tells one of those in view apart.

    Kinds are tried in random order, and of each all that is true of the target.

    Returns:
        `NO_PHRASE` if every phrase fits something else, too.
    """
    for kind in _shuffled(kinds, rng):
        for claim in claims_about(view, row, kind, rng):
            if distinguishes(claim, view, row):
                return Phrase(in_words(claim, wording, rng), claim, kind)
    return NO_PHRASE


def claims_about(
    view: InView, row: int, kind: PhraseKind, rng: np.random.Generator
) -> Iterator[Claim]:
    """Yield claims of a kind about one of those in view, in random order.

    They are true of it but for what `distinguishes` finds.
    """
    looks = _shuffled(descriptions(view, row), rng)
    match kind:
        case PhraseKind.COLOUR:
            yield from (look for look in looks if look.colour is not None)
        case PhraseKind.BODY:
            own = body_of(int(view.model[row]))
            yield from (look for look in looks if look.body is own)
        case PhraseKind.ACTION:
            for look in looks:
                yield from (
                    look._replace(doing=doing) for doing in _shuffled(tuple(MotionWord), rng)
                )
        case PhraseKind.PLACE:
            for look in looks:
                places = _shuffled(tuple(PicturePlace), rng)
                yield from (look._replace(place=place) for place in places)
        case PhraseKind.RELATION:
            yield from _relations(view, row, looks, rng)


def descriptions(view: InView, row: int) -> list[Claim]:
    """Return how one of those in view looks: its body, or a word that it shares with others, with
    its colour and without it.
    """
    model = int(view.model[row])
    own = body_of(model)
    bodies = [own]
    if own in CAN_BE_CALLED[BodyWord.VEHICLE]:
        car = own in CAN_BE_CALLED[BodyWord.CAR] and own is not BodyWord.VAN
        bodies += [word for word in (BodyWord.CAR, BodyWord.VEHICLE) if car or word != "car"]
    plain = [Claim(body) for body in dict.fromkeys(bodies)]
    if not is_painted(model):
        return plain
    colour = colour_name(view.colour[row].tolist())
    return [*plain, *(claim._replace(colour=colour) for claim in plain)]


def _relations(
    view: InView, row: int, looks: Sequence[Claim], rng: np.random.Generator
) -> Iterator[Claim]:
    """Yield claims about where one of those in view is from another that is told apart."""
    for other in _shuffled([k for k in range(len(view.model)) if k != row], rng):
        for bearing in _shuffled(tuple(Bearing), rng):
            for reference in descriptions(view, other):
                claim = looks[0]._replace(
                    bearing=bearing, other_body=reference.body, other_colour=reference.colour
                )
                if distinguishes(reference, view, other) and holds(claim, view)[row]:
                    yield from (
                        claim._replace(body=look.body, colour=look.colour) for look in looks
                    )
                    break


def contradictory(
    claim: Claim,  # A claim that holds for the target
    view: InView,  # What is in view
    rng: np.random.Generator,  # Chooses the wrong statement
) -> Claim | None:
    """Return a claim with one statement changed so that it fits nothing in view.

    The statement by which the kind tells apart is changed if that is enough: last named first.

    Returns:
        None if something in view fits every change.
    """
    for field, words in (
        ("place", tuple(PicturePlace)),
        ("bearing", tuple(Bearing)),
        ("doing", tuple(MotionWord)),
        ("colour", tuple(COLOUR_NAMES)),
        ("body", tuple(BodyWord)[1:9]),
    ):
        told = getattr(claim, field)
        if told is None:
            continue
        for word in _shuffled([word for word in words if word != told], rng):
            wrong = Claim(**{**claim._asdict(), field: word})
            if not fits(wrong, view).any():
                return wrong
    return None


def _shuffled(items: Sequence[Item], rng: np.random.Generator) -> list[Item]:
    return [items[k] for k in rng.permutation(len(items)).tolist()]
