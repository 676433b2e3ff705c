"""What PTX's instructions do to a lane, in C; after NVIDIA's PTX ISA 8.0.

Registers hold 64 bits. What is shorter lies in the lowest of them, the others are 0; predicates are
0 or 1.
"""

import re
from collections.abc import Callable

__all__ = ["CONTROL", "statement"]

CONTROL = ("bra", "brx.idx", "call", "ret", "exit", "bar.warp.sync", "shfl.sync", "vote.sync")
"""Instructions that `machine.c` has itself, numbered in this order."""

Statement = Callable[[list[str]], str | None]
"""Returns the C of an instruction, from the parts of its name; None: it is not known."""

_OPERATORS = {"add": "+", "sub": "-", "mul": "*", "div": "/", "rem": "%"}
_BITS = {"and": "&", "or": "|", "xor": "^"}
_COMPARISONS = {"eq": "==", "ne": "!=", "lt": "<", "le": "<=", "gt": ">", "ge": ">="}
_MAGNITUDE = {"f32": "0x7FFFFFFF", "f64": "0x7FFFFFFFFFFFFFFF"}
"""All bits of a number but its sign."""
_ROUNDINGS = {"rmi": "floor", "rpi": "ceil", "rzi": "trunc"}


def statement(opcode: str) -> str:
    """Return the C of an instruction, by the macros of `machine.c`.

    Operands are `a`, `b` and `c`, registers as they are.

    Raises:
        ValueError: It is not known here.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(\.[a-z0-9]+)*", opcode):  # it becomes part of a program
        raise ValueError(f"the emulated card does not know the instruction {opcode}")
    parts = opcode.split(".")
    known = _MEMORY.get(parts[0]) or _VALUES.get(parts[0])
    text = known(parts) if known else None
    if text is None:
        raise ValueError(f"the emulated card does not know the instruction {opcode}")
    return text if parts[0] in _MEMORY else f"EACH({text})"


def _c(kind: str) -> str:
    """Return the type of C that is a type of PTX."""
    names = {"f64": "double", "f32": "float", "pred": "uint64_t"}
    if kind in names:
        return names[kind]
    if not re.fullmatch(r"[subf](8|16|32|64)", kind):
        raise ValueError(f"the emulated card does not know the type {kind}")
    return f"{'int' if kind[0] == 's' else 'uint'}{kind[1:]}_t"


def _read(kind: str, register: str) -> str:
    if kind in ("f64", "f32"):
        return f"{kind}({register})"
    return f"(({_c(kind)}){register})"


def _bits(kind: str, value: str) -> str:
    """Return a register's content for a value."""
    if kind in ("f64", "f32"):
        return f"of_{kind}({value})"
    size = re.sub(r"\D", "", kind)
    return f"((uint64_t)(uint{size}_t)({value}))" if size else f"((uint64_t)({value}))"


def _real(parts: list[str]) -> str | None:
    """Return what adds, multiplies and so on: only rounded to the nearest, and nothing fused."""
    name, *how, kind = parts
    value = f"{_read(kind, 'a')} {_OPERATORS[name]} {_read(kind, 'b')}"
    return _bits(kind, value) if how == ["rn"] else None


def _arithmetic(parts: list[str]) -> str | None:
    name, *how, kind = parts
    if kind in ("f32", "f64"):
        return _real(parts)
    a, b = _read(kind, "a"), _read(kind, "b")
    if name in ("div", "rem") and not how:
        # The processor would stop at these, where lanes that do not take part may hold them.
        usual = f"{b} == 0 ? 0 : {a} {_OPERATORS[name]} {b}"
        if kind[0] == "u":
            return _bits(kind, usual)
        return _bits(kind, f"{b} == -1 ? {'0 - a' if name == 'div' else '0'} : {usual}")
    if how == ["hi"]:
        wide = "__int128" if kind[0] == "s" else "unsigned __int128"
        return _bits(kind, f"(({wide}){a} * ({wide}){b}) >> {kind[1:]}")
    if how == ["wide"]:
        wide = f"{kind[0]}{2 * int(kind[1:])}"
        return _bits(wide, f"({_c(wide)}){a} * ({_c(wide)}){b}")
    return _bits(kind, f"a {_OPERATORS[name]} b") if how in ([], ["lo"]) else None


def _mad(parts: list[str]) -> str | None:
    return _bits(parts[2], "a * b + c") if parts[1] == "lo" else None


def _logic(parts: list[str]) -> str:
    return _bits(parts[1], f"a {_BITS[parts[0]]} b")


def _not(parts: list[str]) -> str:
    return "a ^ 1" if parts[1] == "pred" else _bits(parts[1], "~a")


def _shift(parts: list[str]) -> str:
    kind = parts[1]
    size, a = kind[1:], _read(kind, "a")
    count = "(uint32_t)b"
    if parts[0] == "shl":
        return _bits(kind, f"{count} < {size} ? a << ({count} & 63) : 0")
    far = f"{a} >> {int(size) - 1}" if kind[0] == "s" else "0"
    return _bits(kind, f"{count} < {size} ? {a} >> ({count} & {int(size) - 1}) : {far}")


def _field(parts: list[str]) -> str:
    kind = parts[1]
    name = "signed_bits_of" if kind[0] == "s" else "bits_of"
    return _bits(kind, f"{name}((uint64_t){_read(kind, 'a')}, b, c)")


def _extreme(parts: list[str]) -> str:
    name, kind = parts
    if kind in ("f32", "f64"):
        return f"{name}_{kind}(a, b)"
    a, b = _read(kind, "a"), _read(kind, "b")
    return _bits(kind, f"{a} {'<' if name == 'min' else '>'} {b} ? {a} : {b}")


def _compare(parts: list[str]) -> str:
    _, how, kind = parts
    a, b = _read(kind, "a"), _read(kind, "b")
    unordered = f"({a} != {a} || {b} != {b})"
    if how in ("nan", "num"):
        return f"{'!' * (how == 'num')}{unordered}"
    if how == "ne" and kind in ("f32", "f64"):
        return f"{a} != {b} && !{unordered}"
    if how in _COMPARISONS:
        return f"(uint64_t)({a} {_COMPARISONS[how]} {b})"
    return f"{a} {_COMPARISONS[how[:-1]]} {b} || {unordered}"


def _convert(parts: list[str]) -> str | None:
    to, origin = parts[-2:]
    how = parts[1] if len(parts) == 4 else ""
    a = _read(origin, "a")
    if how in _ROUNDINGS:
        if to[0] == "f":
            return _bits(to, f"{_ROUNDINGS[how]}{'f' * (to == 'f32')}({a})")
        return f"{to}_of({a})" if how == "rzi" else None
    if (to[0] == "f") != (how == "rn") and (to, origin) != ("f64", "f32"):
        return None
    return _bits(to, f"({_c(to)}){a}")


def _rounded(expression: str) -> Statement:
    """Return what gives the C of a function of one number, rounded to the nearest."""

    def text(parts: list[str]) -> str | None:
        kind = parts[-1]
        value = expression.format(_read(kind, "a"), "f" * (kind == "f32"))
        return _bits(kind, value) if parts[1:-1] == ["rn"] else None

    return text


def _negated(parts: list[str]) -> str:
    return _bits(parts[1], f"-{_read(parts[1], 'a')}")


def _absolute(parts: list[str]) -> str:
    kind = parts[1]
    if kind in ("f32", "f64"):
        return f"a & {_MAGNITUDE[kind]}"
    a = _read(kind, "a")
    return _bits(kind, f"{a} < 0 ? -{a} : {a}")


def _signed_as(parts: list[str]) -> str:
    magnitude = _MAGNITUDE[parts[1]]
    return f"(a & ~{magnitude}) | (b & {magnitude})"


def _load(parts: list[str]) -> str:
    return f"LOAD({_c(parts[-1])})"


def _store(parts: list[str]) -> str:
    return f"STORE({_c(parts[-1])})"


def _atomic(parts: list[str]) -> str | None:
    kind = _c(parts[-1])
    values = {"add": "old + value", "max": "old > value ? old : value"}
    return f"ATOMIC({kind}, {values[parts[-2]]})" if parts[-2] in values else None


_MEMORY: dict[str, Statement] = {"ld": _load, "st": _store, "atom": _atomic}

_VALUES: dict[str, Statement] = {
    **dict.fromkeys(_OPERATORS, _arithmetic),
    **dict.fromkeys(_BITS, _logic),
    "mad": _mad,
    "not": _not,
    "shl": _shift,
    "shr": _shift,
    "bfe": _field,
    "min": _extreme,
    "max": _extreme,
    "setp": _compare,
    "selp": lambda parts: "c ? a : b",
    "cvt": _convert,
    "mov": lambda parts: "a & 1" if parts[1] == "pred" else "a",  # -1 stands for true
    "cvta": lambda parts: "a",  # memory of all kinds has addresses of this processor
    "neg": _negated,
    "abs": _absolute,
    "copysign": _signed_as,
    "sqrt": _rounded("sqrt{1}({0})"),
    "rcp": _rounded("1 / {0}"),
    "popc": lambda parts: "(uint64_t)__builtin_popcountll(a)",
}
