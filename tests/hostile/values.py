"""Values and contents that no reader and no server expects, shared by the tests of both."""

import json
import random
from collections.abc import Iterator
from typing import Any

__all__ = ["ABSURD", "HUGE_WHOLE", "NOT_FINITE", "TEXTS", "json_contents", "mutated", "with_value"]

NOT_FINITE = (float("inf"), float("-inf"), float("nan"))

ABSURD = (1e300, -1.7e308, 1e30, -1e18, 5e-324)
"""Finite, and far from everything that a flight, a map or a picture has."""

HUGE_WHOLE = (2**31, -(2**31) - 1, 2**62, -(2**63), 2**64, 10**400)
"""Whole numbers beyond the integers of arrays, and one beyond all floats."""

TEXTS = ("\ud800", "\0", "", "x" * 100_000, "1e300", "../../../etc/passwd", "\u202e", "<script>")
"""A lone surrogate, and others that a file name, a page or a terminal does not take."""


def with_value(value: Any, chosen: int, hostile: Any) -> Any:
    """Return nested JSON with the leaf of this number, in the order of `leaves`, replaced."""
    count = -1

    def copied(part: Any) -> Any:
        nonlocal count
        if isinstance(part, dict):
            return {key: copied(inner) for key, inner in part.items()}
        if isinstance(part, list):
            return [copied(inner) for inner in part]
        count += 1
        return hostile if count == chosen else part

    return copied(value)


def leaves(value: Any) -> Iterator[Any]:
    """Yield the numbers, texts and truth values of nested JSON."""
    if isinstance(value, dict | list):
        for part in value.values() if isinstance(value, dict) else value:
            yield from leaves(part)
    else:
        yield value


def json_contents(value: Any, chance: random.Random, most: int) -> Iterator[bytes]:
    """Yield up to `most` texts of JSON in which one leaf is hostile, and the ones that break
    parsers: depth, length of numbers, double keys.
    """
    count = sum(1 for _ in leaves(value))
    hostile = (*ABSURD, *NOT_FINITE, *HUGE_WHOLE, *TEXTS, None, True, [], {})
    cases = [(leaf, bad) for leaf in range(count) for bad in hostile]
    for leaf, bad in chance.sample(cases, min(most, len(cases))):
        yield json.dumps(with_value(value, leaf, bad)).encode()
    yield json.dumps(with_value(value, 0, 0)).encode().replace(b"0", b"1" * 5000, 1)
    yield b"[" * 100_000
    yield b'{"a":' * 100_000
    yield b'{"a": 1, "a": 2}'
    yield from (b"null", b"[]", b"{}", b"0", b'"\\ud800"', b"\xff\xfe{\x00}\x00", b"")


def mutated(content: bytes, chance: random.Random, most: int) -> Iterator[bytes]:
    """Yield up to `most` contents that are cut off or have a few flipped, replaced or double
    bytes.
    """
    for share in (0.0, 0.01, 0.3, 0.9):
        yield content[: int(share * len(content))]
    yield content[:-1]
    for _ in range(most - 5):
        made = bytearray(content)
        for _ in range(chance.choice((1, 1, 2, 8))):
            at = chance.randrange(len(made))
            kind = chance.randrange(3)
            if kind == 0:
                made[at] ^= 1 << chance.randrange(8)
            elif kind == 1:
                made[at : at + chance.choice((1, 4, 8))] = chance.choice(
                    (b"\0" * 4, b"\xff" * 4, b"\x7f\xf0", b"1e300", b"-", b'"')
                )
            else:
                made[at:at] = made[at : at + chance.choice((1, 16))]
        yield bytes(made)
