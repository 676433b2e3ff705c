"""Flights of people as a file: what they held at each look, from which each flight can be repeated.

The file is a log of lines of JSON, see `docs/demo.md`: first what people see and do, then of each
attempt who begins it, and what came of it.
"""

import json
import os
from collections.abc import Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from eyas.benchmark.policies.table import PERSON
from eyas.engine.core.config import Config, shown, validated
from eyas.engine.core.decoding import decoded_json
from eyas.engine.core.errors import ConfigError, DataFileError
from eyas.engine.core.files import read_limited, refusals
from eyas.engine.policies.policy import Decision, Failure, PolicyInput, Start, env_config

_LARGEST = 1 << 28  # Largest size of a file [bytes]
_LOOKS = 100_000  # Most looks of a flight: 18,400 in the longest protocol

Device = Literal["keyboard", "gamepad", "touch"]
Numbers = tuple[Annotated[int, Field(ge=1, le=_LOOKS)], tuple[float, ...]]
"""Number of looks over which an action is held, and the action."""


class Attempt(Config):
    """An episode that someone begins."""

    attempt: Annotated[int, Field(ge=1)]
    """From 1, in the order in which they begin."""
    episode: Annotated[str, Field(max_length=1000)]
    """Name of the episode; each has one attempt."""
    pilot: Annotated[str, Field(min_length=1, max_length=40)]
    """Name or number of the person."""
    device: Device


class Flown(Config):
    """What came of an attempt."""

    attempt: Annotated[int, Field(ge=1)]
    actions: tuple[Numbers, ...]
    """The actions of all looks, in order."""
    left: Annotated[str, Field(max_length=200)] = ""
    """Why the flight was left; empty: it was flown to its end."""
    picture_ms: Annotated[float, Field(ge=0)] | None = None
    """Median time from a picture of the simulator until it is on the screen."""
    pace: Annotated[float, Field(ge=0)] | None = None
    """Seconds of the flight in a second: 1 where the machine keeps up."""


class PersonLog(NamedTuple):
    """What a file holds."""

    env: Mapping[str, Any]  # Changes of the defaults of `env`
    attempts: dict[int, Attempt]
    flown: dict[int, Flown]

    @property
    def of_episodes(self) -> dict[str, Flown]:
        """The flights by the name of their episode; an attempt without end has no actions."""
        return {
            own.episode: self.flown.get(number) or Flown(attempt=number, actions=(), left=BROKEN)
            for number, own in self.attempts.items()
        }


BROKEN = "the demo ended in the middle of the flight"


def read_log(path: Path) -> PersonLog:
    """Return what a file of flights holds, without a torn last line.

    Raises:
        DataFileError: It cannot be read, or is no such file.
    """
    content = read_limited(path, _LARGEST)
    log, width = PersonLog({}, {}, {}), 0
    for number, line in enumerate(content.split(b"\n")[:-1], 1):
        try:
            values = decoded_json(line)
            if not isinstance(values, dict):
                raise ValueError("not a JSON object")
            if number == 1:
                log = log._replace(env=_env_of(values))
                width = env_config(log.env).actions.size
            else:
                _enter(log, values, width)
        except (ValueError, ConfigError) as error:
            raise DataFileError(f"{path}: line {number}: not of flights: {error}") from None
    if not log.env:
        raise DataFileError(f"{path}: not a file of flights: it is empty")
    return log


def _env_of(values: Mapping[str, Any]) -> Mapping[str, Any]:
    env = values.get("env")
    if values.keys() != {"env"} or not isinstance(env, dict) or not env:
        raise ValueError("the first line must be what people see and do: {'env': {...}}")
    env_config(env)
    return env


def _enter(log: PersonLog, values: Mapping[str, Any], width: int) -> None:
    if "episode" in values:
        begun = validated(Attempt, dict(values))
        if begun.attempt != len(log.attempts) + 1:
            raise ValueError(f"attempt {shown(begun.attempt)} stands where the next one begins")
        if any(begun.episode == other.episode for other in log.attempts.values()):
            raise ValueError(f"a second attempt at {shown(begun.episode)}: each episode has one")
        log.attempts[begun.attempt] = begun
        return
    ended = validated(Flown, dict(values))
    if ended.attempt not in log.attempts or ended.attempt in log.flown:
        raise ValueError(f"attempt {ended.attempt} ends, but has not begun, or has ended before")
    if sum(count for count, _ in ended.actions) > _LOOKS:
        raise ValueError(f"actions: more than {_LOOKS} looks")
    for _, action in ended.actions:
        if len(action) != width:
            raise ValueError(f"actions: {shown(action)}: {width} numbers are allowed")
    log.flown[ended.attempt] = ended


def append(path: Path, line: Mapping[str, Any] | Attempt | Flown) -> None:
    """Add a line to a file of flights; it is on the disk when this returns.

    Raises:
        OutputError: The file cannot be written.
    """
    text = line.model_dump_json() if isinstance(line, Config) else json.dumps(line)
    with refusals(path), path.open("ab+") as file:
        file.seek(0)
        file.truncate(file.read().rfind(b"\n") + 1)  # a line torn by a kill
        file.write(text.encode() + b"\n")
        file.flush()
        os.fsync(file.fileno())


def in_spans(actions: Sequence[tuple[float, ...]]) -> tuple[Numbers, ...]:
    """Return actions of consecutive looks as spans over which they are the same."""
    return tuple((len(list(same)), action) for action, same in groupby(actions))


class RecordedPeople:
    """Flies episodes as people have flown them."""

    sampled = False
    told = frozenset({PERSON, "box", "words"})

    def __init__(self, path: Path, changes: Mapping[str, Any], *, sampled: bool = False) -> None:
        if sampled:
            raise ConfigError("--sample: not allowed for flights of people")
        if changes:
            raise ConfigError(f"--set env: not allowed for {path}: people have flown as it says")
        self._log = read_log(path)
        self.env = env_config(self._log.env)
        self._names: Sequence[str] = ()

    def choose(self, names: Sequence[str]) -> None:
        """Take the names of the episodes that begin next."""
        self._names = names

    def begin(self, start: Start) -> None:
        """Unpack the flights of the episodes."""
        known = self._log.of_episodes
        missing = Flown(attempt=1, actions=(), left="this episode has no recorded flight")
        own = [known.get(name, missing) for name in self._names or [""] * len(start.seeds)]
        self._actions = [[each for count, each in one.actions for _ in range(count)] for one in own]
        self._left = [one.left for one in own]
        self._next = [0] * len(own)
        self._held = np.zeros((len(own), self.env.actions.size))

    def act(self, sight: PolicyInput) -> Decision:
        """Do what was done at this look; where a flight was left, it fails."""
        failed = {}
        for row in np.flatnonzero(sight.deciding).tolist():
            if self._next[row] < len(self._actions[row]):
                self._held[row] = self._actions[row][self._next[row]]
                self._next[row] += 1
            else:
                failed[row] = Failure(self._left[row] or "the recording ends here", None)
        return Decision(self._held.copy(), failed)
