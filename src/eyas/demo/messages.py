"""What a page may say: one JSON object for each message, of bounded size and checked values."""

import json
from typing import Annotated, Any, Literal

from pydantic import Field

from eyas.benchmark.policies.person import Device
from eyas.demo.controls import Control
from eyas.demo.frame import Coding
from eyas.engine.core.config import Config, validated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.task.config import RewardMode, RewardType

LONGEST = 4096  # Largest message [bytes]
LONGEST_LINK = 300  # Of a film, with the address before it [characters]

Share = Annotated[float, Field(ge=0, le=1)]
Side = Annotated[int, Field(ge=16, le=16384)]
Name = Annotated[str, Field(max_length=200)]
Positive = Annotated[float, Field(gt=0, le=1000)]
Light = Literal["own", "bright", "dim", "dark"]
Hour = Annotated[float, Field(ge=0.0, le=24.0)]

LIGHTS: dict[Light, tuple[float, float]] = {
    "own": (0.0, 0.0),
    "bright": (1.3, 1.2),
    "dim": (0.45, 0.6),
    "dark": (0.12, 0.3),
}
"""Brightness of sun and sky in shares of the weather's own; `own` changes nothing."""


class Message(Config):
    """Something that a page says."""


class KeysMessage(Message):
    """The controls that are held now; sent on a change and every 100 ms."""

    held: dict[Control, Share]
    sequence: Annotated[int, Field(ge=0)]
    time: float
    """Time of the last change by the page's clock [ms]; it comes back with each frame."""


class AckMessage(Message):
    """A frame has arrived and is shown."""

    frame: Annotated[int, Field(ge=0)]
    spent: Annotated[float, Field(ge=0, le=60000)] = 0.0
    """Time from its arrival until then [ms]."""


class PicturesMessage(Message):
    """How pictures for this viewer are coded; H.264 begins anew, with a whole picture."""

    coding: Coding


class LookMessage(Message):
    """What the picture shows, and how large it is on the screen."""

    view: Literal["drone", "chase", "top"] = "drone"
    overlay: bool = True
    width: Side = 640
    height: Side = 360


class ClickMessage(Message):
    """A place in the picture: from its left and upper edge, in shares of its sides."""

    x: Share
    y: Share


class DoMessage(Message):
    """Something to do once; `pilot` takes the controls."""

    what: Literal["next_target", "parked_target", "reset", "step", "pilot"]


class PaceMessage(Message):
    """Seconds of the simulation in a second; 0: it stands still."""

    speed: Annotated[float, Field(ge=0, le=4)]


class RewardMessage(Message):
    """Settings of the reward; those that are not named stay."""

    type: RewardType | None = None
    mode: RewardMode | None = None
    view_range: Annotated[float, Field(gt=0, le=10)] | None = None
    view_scale: Positive | None = None
    distance_range: Positive | None = None
    distance_scale: Positive | None = None


class WorldMessage(Message):
    """Another world; what is not named stays."""

    map: Name | None = None
    weather: Name | None = None
    vehicles: Annotated[int, Field(ge=1, le=100)] | None = None
    target: Name | None = None
    tracker: Literal["drone", "flown", "car"] | None = None
    light: Light | None = None
    hour: Hour | Literal["own"] | None = None
    """Time of day; `own`: the weather's sun, as in any weather that is night."""
    people: Annotated[int, Field(ge=0, le=100)] | None = None
    """Those who walk around without being asked for as targets: people and robots."""


class FlyMessage(Message):
    """Who flies: a policy, or None for the pilot's keys."""

    policy: Name | None


class DuelMessage(Message):
    """The same minute flown by the pilot and by a policy; None: give up."""

    policy: Name | None


class FilmMessage(Message):
    """A film by its link, or a new one of a policy in this world."""

    link: Annotated[str, Field(max_length=LONGEST_LINK)] | None = None
    policy: Name | None = None


class RecordMessage(Message):
    """Whether to record."""

    on: bool


class BoxMessage(Message):
    """Where an outside tracker sees the target, to fly by it; None: it sees none.

    Left, top, right, bottom, in shares of the picture's sides.
    """

    box: tuple[Share, Share, Share, Share] | None


class ReadyMessage(Message):
    """Somebody begins the next flight that is recorded for a leaderboard."""

    pilot: Annotated[str, Field(min_length=1, max_length=40)]
    device: Device


class LeaveMessage(Message):
    """The flight that is recorded is left, and counts as far as it was flown."""


class StageMessage(Message):
    """Fly for the leaderboard, in a protocol; None: freely."""

    protocol: Name | None


_KINDS: dict[str, type[Message]] = {
    "keys": KeysMessage,
    "ack": AckMessage,
    "pictures": PicturesMessage,
    "look": LookMessage,
    "click": ClickMessage,
    "do": DoMessage,
    "pace": PaceMessage,
    "reward": RewardMessage,
    "world": WorldMessage,
    "fly": FlyMessage,
    "duel": DuelMessage,
    "film": FilmMessage,
    "record": RecordMessage,
    "box": BoxMessage,
    "ready": ReadyMessage,
    "leave": LeaveMessage,
    "stage": StageMessage,
}


def parsed(text: str | bytes) -> Message:
    """Return the message that a text holds: `{"message": "keys", ...}`.

    Raises:
        ConfigError: It holds something else; the message is one line.
    """
    if isinstance(text, bytes):
        raise ConfigError("message: bytes are not allowed; allowed: text")
    try:
        values: Any = json.loads(text)
    except (ValueError, RecursionError):
        raise ConfigError("message: not JSON") from None
    if not isinstance(values, dict):
        raise ConfigError("message: not allowed; allowed: a JSON object")
    said = values.pop("message", None)
    if not isinstance(said, str) or said not in _KINDS:
        raise UnknownNameError("message", str(said)[:40], tuple(_KINDS))
    return validated(_KINDS[said], values, said)
