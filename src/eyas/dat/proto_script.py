"""Values and functions of the scripts in Webots' `.proto` files, see `eyas.dat.proto_template`.

Numbers are floats; arrays of JavaScript are lists, its objects and tables of Lua dictionaries. What
is called is only ever a function of this file or of the script: no attribute of a Python object is
looked up by a name from a file.
"""

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from eyas.lanes import exact

_MOST_STEPS = 1_000_000
"""Steps of all templates of a shape together: seconds, ten times what real ones take."""

Function = Callable[..., object]


class Limits:
    """Counts what all templates of a shape do together."""

    def __init__(self, most: int = _MOST_STEPS) -> None:
        self._left = float(most)

    def spend(self, steps: float = 1.0) -> None:
        """Count steps; `ValueError` once there were too many."""
        self._left -= 1.0 + steps
        if not self._left >= 0.0:
            raise ValueError("its template computes for too long")

    def text(self, parts: list[str]) -> str:
        """Return texts as one, whose length counts."""
        self.weigh(*parts)
        return "".join(parts)

    def weigh(self, *values: object) -> None:
        """Count what a function that looks at all of some values does."""
        self.spend(sum(len(one) for one in values if isinstance(one, str | list | dict)) / 16.0)

    def weighed(self, function: Function) -> Function:
        """Return a function that counts how large its arguments are."""

        def call(*values: object) -> object:
            self.weigh(*values)
            return function(*values)

        return call


def shown(value: object) -> str:
    """Return a plain value as text, as a template puts it out."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "TRUE" if value else "FALSE"
    if isinstance(value, float):
        return f"{value:.0f}" if abs(value) < 1e15 and value == math.floor(value) else repr(value)
    if value is None:
        return "NULL"
    raise ValueError("its template puts out a list or a node, which is not read")


def number(value: object) -> float:
    """Return a number; `ValueError` if it is none."""
    if not isinstance(value, float):
        raise ValueError("its template computes with what is no number")
    return value


def same(a: object, b: object) -> bool:
    """Return whether two values are equal; of lists and nodes, whether they are one."""
    if isinstance(a, str | float | bool) and type(a) is type(b):
        return a == b
    return a is b


def divided(a: float, b: float) -> float:
    """Return a quotient, infinite or not a number where the divisor is 0."""
    return a / b if b else (math.nan if a == 0.0 or math.isnan(a) else math.copysign(math.inf, a))


def power(a: float, b: float) -> float:
    """Return a power."""
    with np.errstate(all="ignore"):  # what is too large is infinite
        return float(exact.power(a, int(b) if abs(b) < 1e6 and b == math.floor(b) else b))


ARITHMETIC: dict[str, Callable[[float, float], Any]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": divided,
    "**": power,
    "//": lambda a, b: math.floor(divided(a, b)) + 0.0,
    "%": lambda a, b: math.fmod(a, b),
    "mod": lambda a, b: a - math.floor(divided(a, b)) * b,
}
"""Operators of two numbers; the remainder of Lua is `mod`."""

COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<": lambda a, b: a < b,
    ">": lambda a, b: a > b,
    "<=": lambda a, b: a <= b,
    ">=": lambda a, b: a >= b,
}
"""Operators of two numbers or two texts."""


def _of(function: Callable[..., Any]) -> Function:
    """Return a function of numbers as one of values."""

    def call(*values: object) -> float:
        with np.errstate(all="ignore"):
            return float(function(*map(number, values)))

    return call


def _formatted(pattern: str, *values: object) -> str:
    """Return values in a pattern of `string.format`, of those without large widths."""
    rest = iter(values)

    def put(found: re.Match[str]) -> str:
        if found[0] == "%%":
            return "%"
        value = next(rest)
        if found[0].endswith("s"):
            return found[0] % shown(value)
        plain = number(value)
        return found[0] % (math.floor(plain) if found[0][-1] in "di" else plain)

    return re.sub(r"%%|%[-+0]?\d{0,2}(?:\.\d{1,2})?[dfgis]", put, pattern)


def _words(text: str, pattern: str) -> Iterator[tuple[str]]:
    """Yield what a pattern of Lua finds, of patterns that are one class of characters."""
    classes = {"%w+": r"[^\W_]+", "%S+": r"\S+", "%d+": r"\d+", "%a+": r"[^\W\d_]+", ".": "."}
    if pattern not in classes:
        raise ValueError(f"its template looks for {pattern!r:.40}, which is not read")
    return ((found,) for found in re.findall(classes[pattern], text, re.ASCII))


def _slice(values: Any, first: float = 0.0, last: float = math.inf) -> Any:  # noqa: ANN401
    count = len(values)
    ends = [max(at + count, 0.0) if at < 0.0 else min(at, count) for at in (first, last)]
    return values[int(ends[0]) : int(ends[1])]


def _sub(text: str, first: float, last: float = -1.0) -> str:
    ends = [at + len(text) + 1 if at < 0.0 else at for at in (first, last)]
    return text[int(max(ends[0], 1.0)) - 1 : int(max(min(ends[1], len(text)), 0.0))]


def _parsed(text: object, *_: object) -> float:
    """Return the number at the start of a text."""
    found = re.match(r"\s*[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", shown(text), re.IGNORECASE)
    return float(found[0]) if found else math.nan


def _to_number(text: object) -> float | None:
    found = _parsed(text)
    return None if math.isnan(found) else found


def _insert(limits: Limits, table: dict[object, object], *values: object) -> None:
    if len(values) == 2:
        limits.spend(len(table))
        at, last = number(values[0]), length(table)
        for k in range(int(last), int(at) - 1, -1):
            table[k + 1.0] = table[float(k)]
        table[at] = values[1]
    else:
        table[length(table) + 1.0] = values[0]


def length(value: object) -> float:
    """Return how many elements a text, a list or a table of Lua has."""
    if isinstance(value, str | list):
        return float(len(value))
    if not isinstance(value, dict):
        raise ValueError("its template counts what is no list")
    count = len(value)
    if float(count) not in value and count:  # it has names, too
        count = next(k for k in range(count + 1) if float(k + 1) not in value)
    return float(count)


_ANGLES: dict[str, object] = {
    name: _of(getattr(exact, name)) for name in ("sin", "cos", "tan", "asin", "acos", "exp", "log")
}
_MATHS: dict[str, object] = {
    **_ANGLES,
    "sqrt": _of(math.sqrt),
    "abs": _of(abs),
    "floor": _of(math.floor),
    "ceil": _of(math.ceil),
    "max": _of(max),
    "min": _of(min),
    "pow": _of(power),
}


class _Chance:
    """Numbers that look drawn, the same in each run."""

    def __init__(self) -> None:
        self._state = 1

    def seed(self, value: object = 0.0) -> None:
        """Begin anew."""
        self._state = int(number(value)) & 0xFFFFFFFF

    def real(self, *ends: object) -> float:
        """Return a number from 0, or the first of two, to the other end."""
        self._state = (self._state * 1664525 + 1013904223) & 0xFFFFFFFF
        low, high = (0.0, 1.0, *map(number, ends))[-2:] if len(ends) != 1 else (0.0, number(*ends))
        return low + (high - low) * (self._state / 2.0**32)

    def integer(self, *ends: object) -> float:
        """Return a whole number from 1, or the first of two, to the last."""
        low, high = (1.0, *map(number, ends))[-2:] if ends else (0.0, 2.0**31)
        return math.floor(self.real(low, high + 1.0)) + 0.0


def names_of(limits: Limits, *, lua: bool) -> dict[str, object]:
    """Return what a script may use without having made it."""
    chance = _Chance()
    drawn = {"seed": chance.seed, "real": chance.real, "integer": chance.integer}
    silent: Function = lambda *_: None  # noqa: E731
    if not lua:
        more = {
            "PI": math.pi, "E": math.e, "SQRT2": math.sqrt(2.0), "random": chance.real,
            "atan": _of(exact.atan), "atan2": _of(exact.atan2), "hypot": _of(exact.hypot),
            "round": _of(lambda a: math.floor(a + 0.5)), "trunc": _of(math.trunc),
            "sign": _of(lambda a: (a > 0.0) - (a < 0.0)),
            "cbrt": _of(exact.cbrt), "tanh": _of(exact.tanh), "log2": _of(exact.log2),
        }  # fmt: skip
        return {
            "Math": _MATHS | more, "wbrandom": drawn, "NaN": math.nan, "Infinity": math.inf,
            "console": dict.fromkeys(("log", "error", "warn", "info"), silent),
            "parseInt": lambda text, *_: math.trunc(_parsed(text)) + 0.0, "parseFloat": _parsed,
            "Number": _parsed, "String": shown, "isNaN": lambda a: math.isnan(number(a)),
            "Array": {"isArray": lambda a: isinstance(a, list)},
            "Object": {
                "keys": limits.weighed(list),
                "values": limits.weighed(lambda a: list(a.values())),
            },
        }  # fmt: skip

    def items(table: dict[object, object]) -> Iterator[tuple[object, object]]:
        return iter(list(table.items()))

    def in_order(table: dict[object, object]) -> Iterator[tuple[object, object]]:
        return ((float(k), table[float(k)]) for k in range(1, int(length(table)) + 1))

    def module(name: object) -> object:
        if name != "wbrandom":
            raise ValueError(f"its template needs the module {name!r:.40}, which is not read")
        return drawn

    return {
        "math": _MATHS | {
            "pi": math.pi, "huge": math.inf, "fmod": _of(math.fmod),
            "atan": _of(lambda a, b=1.0: exact.atan2(a, b)), "atan2": _of(exact.atan2),
            "rad": _of(lambda a: a * (math.pi / 180.0)),
            "deg": _of(lambda a: a * (180.0 / math.pi)),
            "random": lambda *ends: chance.integer(*ends) if ends else chance.real(),
            "randomseed": chance.seed,
        },
        "string": _lua_texts(limits),
        "table": {
            "insert": lambda table, *values: _insert(limits, table, *values),
            "getn": length,
            "maxn": length,
            "concat": lambda table, *between: _lists(limits)["join"](
                [value for _, value in in_order(table)], *between or ("",)
            ),
        },
        "pairs": limits.weighed(items), "ipairs": in_order,
        "tostring": shown, "tonumber": _to_number,
        "print": silent, "io": {"stderr": {"write": silent}, "write": silent},
        "require": module,
    }  # fmt: skip


def _lua_texts(limits: Limits) -> dict[str, Function]:
    def times(text: str, count: object) -> str:
        limits.spend(len(text) * max(number(count), 0.0))
        return text * int(number(count))

    functions: dict[str, Function] = {
        "format": _formatted, "gmatch": _words, "sub": _sub, "len": length, "rep": times,
        "lower": str.lower, "upper": str.upper,
    }  # fmt: skip
    return {name: limits.weighed(function) for name, function in functions.items()}


def _script_texts(limits: Limits) -> dict[str, Function]:
    def split(text: str, between: str) -> list[str]:
        limits.spend(len(text))
        return text.split(between) if between else list(text)

    def times(text: str, count: object) -> str:
        limits.spend(len(text) * max(number(count), 0.0))
        return text * int(number(count))

    def replaced(text: str, old: object, new: object) -> str:
        """Return a text with another in the place of a part, or of all blanks."""
        put = shown(new)[:100]
        if isinstance(old, re.Pattern):
            return limits.text([old.sub(lambda _: put, text)])
        return limits.text([text.replace(shown(old), put, 1)])

    return {
        "split": split, "repeat": times, "slice": _slice, "substring": _slice, "trim": str.strip,
        "toLowerCase": str.lower, "toUpperCase": str.upper, "startsWith": str.startswith,
        "endsWith": str.endswith, "includes": str.__contains__, "toString": str,
        "indexOf": lambda text, part: float(text.find(part)),
        "charAt": lambda text, at=0.0: text[int(at) : int(at) + 1],
        "replace": replaced,
    }  # fmt: skip


def _lists(limits: Limits) -> dict[str, Function]:
    def push(values: list[object], *more: object) -> float:
        values += more
        return float(len(values))

    def joined(values: list[object], between: str = ",") -> str:
        texts = [shown(value) for value in values]
        return limits.text([between[:1000] * bool(k) + text for k, text in enumerate(texts)])

    def mapped(values: list[object], function: Function) -> list[object]:
        return [function(value, float(k)) for k, value in enumerate(list(values))]

    def chained(values: list[object], *others: Any) -> list[object]:  # noqa: ANN401
        limits.spend(len(values) + sum(map(len, others)))
        return [*values, *(value for other in others for value in other)]

    def filled(values: list[object], value: object) -> list[object]:
        values[:] = [value] * len(values)
        return values

    return {
        "push": push, "join": joined, "map": mapped, "forEach": mapped, "concat": chained,
        "fill": filled, "slice": _slice, "pop": lambda values: values.pop() if values else None,
        "shift": lambda values: values.pop(0) if values else None,
        "includes": lambda values, one: any(same(value, one) for value in values),
        "indexOf": lambda values, one: next(
            (float(k) for k, value in enumerate(values) if same(value, one)), -1.0
        ),
        "reverse": lambda values: values.reverse() or values,
    }  # fmt: skip


def methods_of(limits: Limits, *, lua: bool) -> dict[type, dict[str, Function]]:
    """Return the methods of values, by their types."""
    if lua:
        return {str: _lua_texts(limits)}
    texts, lists = _script_texts(limits), _lists(limits)
    rounded: Function = lambda value, digits=0.0: f"{value:.{int(min(digits, 20.0))}f}"  # noqa: E731
    return {
        str: {name: limits.weighed(function) for name, function in texts.items()},
        list: {
            name: function if name in ("push", "pop") else limits.weighed(function)
            for name, function in lists.items()
        },
        float: {"toFixed": rounded, "toString": shown},
        bool: {"toString": shown},
    }
