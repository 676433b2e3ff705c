"""The policies that Eyas has taught itself and brings along, each with a card of where it is from.

`tools/ship_policy.py` puts them there.
"""

import json
from functools import cache
from importlib.resources import files
from pathlib import Path

from eyas.engine.core.config import Config, validated

TRAINED = Path(str(files("eyas.benchmark.policies"))) / "trained"
"""Folder of the policies: for each name a network (`.onnx`), a card (`.json`) and a curve
(`.csv`)."""


class PolicyCard(Config):
    """Where a policy is from, and what it cannot do; `eyas reproduce` tells what it reaches."""

    title: str
    """What it has learned, in a few words."""
    command: str
    """The command that trained it."""
    entry_class: str = "pixels"
    """What it knows, see `eyas.benchmark.plan.entry.EntryClass`."""
    decisions: int
    """Decisions of all environments in training; of trackers: pictures that they were shown."""
    version: str
    """Version of Eyas that trained it."""
    trained_on: str
    """Places, conditions, targets and episodes of its training, in a few sentences."""
    limits: tuple[str, ...]
    """What it cannot do, as far as is known."""


def shipped_names() -> tuple[str, ...]:
    """Return the names of all."""
    return tuple(sorted(path.stem for path in TRAINED.glob("*.onnx")))


def file_of(name: str) -> Path:
    """Return the network's file."""
    return TRAINED / f"{name}.onnx"


@cache
def card_of(name: str) -> PolicyCard:
    """Return the card of a policy."""
    path = TRAINED / f"{name}.json"
    return validated(PolicyCard, json.loads(path.read_text()), str(path))
