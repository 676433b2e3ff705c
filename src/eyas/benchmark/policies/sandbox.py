"""Policies whose code is not ours, flown in a process of their own.

Whoever's Python runs beside the simulator can read it: by `gc`, by frames, by what it imports. In a
process of its own it has what it is sent: observations, and what the protocol tells at the start;
`isolation.py` closes the rest.
Messages are JSON and raw arrays in both directions, never pickles, which would run its code here.
"""

import atexit
import contextlib
import json
import math
import os
import subprocess
import sys
import weakref
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import IO, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.isolation import close_memory, wrapped
from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.policies.policy import Decision, Failure, PolicyFailedError, PolicyInput, Start
from eyas.engine.settings.env import EnvConfig

Array = NDArray[Any]
Read = TypeVar("Read")

_PLAIN = "biuf"  # Kinds of numbers that arrays of a message may hold

_WRONG = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,  # this and SyntaxError: numpy compiles the names of some types
    RecursionError,
    SyntaxError,
    TypeError,
    ValueError,
)
"""What reading raises where a message is of another form."""

_WORKER = "eyas.benchmark.policies.sandbox_worker"
_LARGEST = 1 << 30  # Largest part of a message [bytes]


def send(stream: IO[bytes], head: Mapping[str, Any], arrays: Sequence[Array] = ()) -> None:
    """Write a message."""
    plain = [np.ascontiguousarray(array) for array in arrays]
    told = {**head, "arrays": [[array.dtype.str, array.shape] for array in plain]}
    text = json.dumps(told).encode()
    stream.write(len(text).to_bytes(4, "little") + text)
    for array in plain:
        stream.write(array.tobytes())
    stream.flush()


def receive(stream: IO[bytes]) -> tuple[dict[str, Any], list[Array]]:
    """Read a message.

    Raises:
        EOFError: There is no whole one.
        ValueError: It is not one.
    """
    size = int.from_bytes(_exactly(stream, 4), "little")
    try:
        head = json.loads(_exactly(stream, size))
        arrays = []
        for name, shape in head.pop("arrays"):
            kind = np.dtype(name)
            if kind.kind not in _PLAIN or any(not 0 <= side < _LARGEST for side in shape):
                raise ValueError(f"an array of {name!r} with shape {shape}")
            data = _exactly(stream, kind.itemsize * math.prod(shape))
            arrays.append(np.frombuffer(bytearray(data), kind).reshape(shape))
    except _WRONG as error:
        raise ValueError(f"{type(error).__name__}: {error}") from None
    return head, arrays


def _exactly(stream: IO[bytes], size: int) -> bytes:
    if size > _LARGEST:
        raise ValueError(f"a message of {size} bytes")
    data = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data


class _Child:
    """The process of a policy."""

    def __init__(self, said: str, changes: Mapping[str, Any], *, sampled: bool) -> None:
        paths = [path for path in sys.path if path]
        close_memory()
        self._process = subprocess.Popen(
            [*wrapped(), sys.executable, "-c", f"from {_WORKER} import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        )
        opened = {"said": said, "changes": changes, "sampled": sampled, "paths": sys.path}
        try:
            self.answer = self.ask(opened, (), lambda answer, _: answer)
        except PolicyFailedError as error:
            raise ConfigError(f"--policy: '{said}': {error.failure.line}") from None
        if "refused" in self.answer:
            self.close()
            raise ConfigError(self.answer["refused"])

    @property
    def alive(self) -> bool:
        """Whether it runs."""
        return self._process.poll() is None

    def ask(
        self, head: Mapping[str, Any], arrays: Sequence[Array], read: Callable[..., Read]
    ) -> Read:
        """Send a message and return what `read` makes of the answer: its head and its arrays.

        Raises:
            PolicyFailedError: The policy has failed as a whole, or its process has ended.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            send(self._process.stdin, head, arrays)
            answer, parts = receive(self._process.stdout)
            if "failure" in answer:
                raise PolicyFailedError(Failure(*answer["failure"]))
            return read(answer, parts)
        except (OSError, EOFError):
            self.close()
            raise PolicyFailedError(Failure(self._how_ended(), None)) from None
        except _WRONG as error:
            self.close()
            line = f"the policy's process has answered what is no answer: {error}"
            raise PolicyFailedError(Failure(line, None)) from None

    def close(self) -> None:
        """End the process."""
        for stream in (self._process.stdin, self._process.stdout):
            assert stream is not None
            with contextlib.suppress(OSError):
                stream.close()  # at which it ends, unless its code never returns
        try:
            self._process.wait(timeout=1.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _how_ended(self) -> str:
        code = self._process.returncode
        how = f"by signal {-code}" if code < 0 else f"with exit code {code}"
        return f"the policy's process has ended {how}"


_CHILDREN: dict[str, _Child] = {}
"""Processes that have not flown yet, by what they have opened."""

_KEPT = 4  # Largest number of them


@atexit.register
def _close_all() -> None:
    for child in _CHILDREN.values():
        child.close()
    _CHILDREN.clear()


def open_sandboxed(said: str, changes: Mapping[str, Any], *, sampled: bool) -> "SandboxedPolicy":
    """Return a policy that flies in a process of its own; arguments as of `open_policy`.

    Raises:
        ConfigError: There is no such policy, or it cannot be loaded.
    """
    key = json.dumps([said, changes, sampled, sys.path])
    make = partial(_Child, said, changes, sampled=sampled)
    child = _CHILDREN.pop(key, None)
    if child is None or not child.alive:
        child = make()
    _CHILDREN[key] = child
    while len(_CHILDREN) > _KEPT:
        _CHILDREN.pop(next(iter(_CHILDREN))).close()
    return SandboxedPolicy(child, partial(_taken, key, make))


def _taken(key: str, make: Callable[[], _Child]) -> _Child:
    """Return a process that has not flown yet, which now does."""
    child = _CHILDREN.pop(key, None)
    return child if child is not None and child.alive else make()


class SandboxedPolicy:
    """A policy in a process of its own, a new one for each batch of episodes: what it remembers of
    one start would help it in the next, which has the same traffic in another weather.
    """

    def __init__(
        self,
        child: _Child,
        take: Callable[[], _Child],  # Returns a process that has not flown yet
    ) -> None:
        self._child: _Child | None = None
        self._take = take
        self._end: Callable[[], object] = lambda: None  # Ends the process of the last batch
        self.env = validated(EnvConfig, child.answer["env"])
        self.sampled = bool(child.answer["sampled"])
        self.told = frozenset(map(str, child.answer["told"]))

    def begin(self, start: Start) -> None:
        """Tell that N episodes begin, and what it may know of them by its class of entry: no seeds,
        unless it samples, no words, unless it asks for them.
        """
        seeds = start.seeds if self.sampled else np.zeros_like(start.seeds)
        boxes = start.boxes() if "box" in self.told else np.zeros((len(seeds), 4), np.int32)
        head: dict[str, Any] = {"begin": True, "words": None}
        arrays: list[Array] = [seeds, boxes]
        if start.told is not None and self.told & {"words", "attributes"}:
            head["words"] = list(start.told.words)
            arrays.append(start.told.attributes)
        self._end()
        self._child = self._take()
        self._end = weakref.finalize(self, self._child.close)
        self._child.ask(head, arrays, lambda *_: None)

    def act(self, sight: PolicyInput) -> Decision:
        """Send the observations of those who decide, and return their actions."""
        seen = sight.observation
        parts = seen if isinstance(seen, dict) else {"": seen}
        head = {"act": list(parts), "heard": sight.heard is not None, "clock": sight.clock}
        if sight.told is not None and "words" in self.told:
            head["words"] = list(sight.told.words)
        arrays: list[Array] = [sight.deciding, *(part[sight.deciding] for part in parts.values())]
        if sight.heard is not None:
            arrays.append(sight.heard)
        assert self._child is not None, "a batch begins before it acts"
        return self._child.ask(head, arrays, partial(_decision, len(sight.deciding)))


def _decision(count: int, answer: Mapping[str, Any], parts: Sequence[Array]) -> Decision:
    """Return the decision in an answer, for N drones."""
    if any(len(part) != count for part in parts):
        raise ValueError(f"{[len(part) for part in parts]} rows for {count} drones")
    failed = {int(row): Failure(*told) for row, told in answer["failed"].items()}
    actions, *messages = parts
    return Decision(actions, failed, messages[0] if messages else None)
