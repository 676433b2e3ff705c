"""A program in PTX as the emulated card runs it: its instructions, with numbers for all names.

It knows the PTX that LLVM writes: registers by type, conditions of branches only, parameters of
functions that are single registers, no recursion. So each register, parameter and constant of a
program has a place of its own, and a call copies what it is given.
"""

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from emulated_card.instructions import CONTROL
from emulated_card.meetings import meetings

__all__ = ["INSTRUCTION", "Program", "read_program"]

INSTRUCTION = np.dtype(
    [
        ("code", "i4"),
        ("leads", "i4"),  # whether a branch comes here
        ("guard", "i4"),  # of a branch: the register that it depends on, or -1
        ("wanted", "i4"),  # and what that must hold
        ("d", "i4"),  # registers: of the result, and of up to three operands
        ("a", "i4"),
        ("b", "i4"),
        ("c", "i4"),
        ("meet", "i4"),  # of a branch: where threads that part there meet again, or -1: nowhere
        ("unused", "i4"),
        ("offset", "i8"),  # of an address; of a branch or call: the instruction that it leads to
    ]
)

_SPECIAL = ("%tid.x", "%ntid.x", "%ctaid.x")

_FUNCTION = re.compile(
    r"^(?:\.visible )?\.(?P<kind>entry|func)\s+(?:\([^)]*\)\s*)?(?P<name>[\w$]+)\s*"
    r"\((?P<given>[^)]*)\)[^{;]*\{\n(?P<body>.*?)^\}",
    re.MULTILINE | re.DOTALL,
)
_TABLE = re.compile(r"(\$\w+): \.branchtargets\s+([^;]*);")
_SYMBOL = re.compile(
    r"\.(shared|local|global) \.align \d+ \.(?:b8|u64)\s+([\w$]+)\[(\d+)\](?:\s*=\s*\{([^}]*)\})?;"
)

Places = list[tuple[int, int]]
"""Registers, and what they hold, or the offsets of the addresses that they hold."""


class Program(NamedTuple):
    """A kernel."""

    entry: str
    start: int
    """Its first instruction."""
    instructions: NDArray[np.void]
    lines: list[str]
    """The text of each."""
    targets: NDArray[np.int32]
    """Of branches by a table: how many there are, then the instructions."""
    registers: int
    constants: Places
    special: list[int]
    """Registers of the thread's number, the size of its block, the block's number."""
    parameters: list[int]
    shared: Places
    """Addresses in memory that a block shares."""
    shared_size: int
    local: Places
    """Addresses in a thread's own memory."""
    local_size: int
    data: Places
    """Addresses in the program's own memory."""
    content: bytes
    """What that holds."""


def read_program(text: str, codes: dict[str, int]) -> Program:
    """Return a program.

    Args:
        text: The PTX.
        codes: Number of each instruction; what is not in it is added.

    Raises:
        ValueError: Something in it is not known here; the message says what.
    """
    return _Reader(codes).read(text)


class _Reader:
    def __init__(self, codes: dict[str, int]) -> None:
        self._codes = codes
        self._registers: dict[str | int, int] = {}
        self._offsets: dict[str, dict[str, int]] = {"shared": {}, "local": {}, "global": {}}
        self._sizes = {"shared": 0, "local": 0, "global": 0}
        self._content = b""
        self._rows: list[tuple[int, ...]] = []
        self._lines: list[str] = []
        self._labels: dict[str, int] = {}
        self._formals: dict[str, list[str]] = {}
        self._jumps: dict[int, str] = {}
        self._tables: dict[str, list[str]] = {}
        self._function = ""

    def read(self, text: str) -> Program:
        text = re.sub(r"//[^\n]*", "", text)
        for found in _SYMBOL.finditer(text):
            self._place(*found.groups())
        functions = list(_FUNCTION.finditer(text))
        for one in functions:
            self._formals[one["name"]] = re.findall(r"([\w$]+)\s*(?:,|$)", one["given"])
        for one in functions:
            self._function = one["name"]
            self._labels[self._function] = len(self._rows)
            self._body(one["body"])
        entries = [one["name"] for one in functions if one["kind"] == "entry"]
        if len(entries) != 1:
            raise ValueError(f"the emulated card runs programs with one entry, not {len(entries)}")
        return self._program(entries[0], [one["name"] for one in functions])

    def _program(self, entry: str, functions: list[str]) -> Program:
        instructions = np.array(self._rows, INSTRUCTION)
        targets: list[int] = []
        for row, name in self._jumps.items():
            if name in self._tables:
                instructions["offset"][row] = len(targets)
                ways = [self._labels[label] for label in self._tables[name]]
                targets += [len(ways), *ways]
            else:
                instructions["offset"][row] = self._labels[name]
        instructions["leads"][list(self._labels.values())] = 1
        starts = [self._labels[name] for name in functions]
        instructions["meet"] = meetings(instructions, np.array(targets, np.int32), starts)
        shared, local, data = (
            [(self._register(name), at) for name, at in self._offsets[space].items()]
            for space in ("shared", "local", "global")
        )
        special, parameters = (
            [self._register(name) for name in names] for names in (_SPECIAL, self._formals[entry])
        )
        constants = [(at, name) for name, at in self._registers.items() if isinstance(name, int)]
        return Program(
            entry, self._labels[entry], instructions, self._lines, np.array(targets, np.int32),
            len(self._registers), constants, special, parameters, shared, self._sizes["shared"],
            local, self._sizes["local"], data, self._content,
        )  # fmt: skip

    def _place(self, space: str, name: str, size: str, content: str | None) -> None:
        """Give memory a place; what pointers point to at first is not needed by what runs here."""
        at = -(-self._sizes[space] // 16) * 16
        self._offsets[space][name] = at
        self._sizes[space] = at + int(size) * (8 if content and "generic" in content else 1)
        if content and "generic" not in content:
            self._content = self._content.ljust(at, b"\0")
            self._content += bytes(int(value) for value in content.split(","))

    def _body(self, body: str) -> None:
        for name, labels in _TABLE.findall(body):
            self._tables[name] = re.findall(r"[$\w]+", labels)
        for line in _TABLE.sub("", body).splitlines():
            text = " ".join(line.split()).rstrip(";")
            if text.endswith(":"):
                self._labels[text[:-1]] = len(self._rows)
            elif text and text[0] not in ".{}":
                self._instruction(text)

    def _instruction(self, text: str) -> None:
        found = re.fullmatch(r"(?:@(!?)(%p\d+) )?(\S+)(?: (.*))?", text)
        assert found is not None  # for any line
        negated, guard, opcode, rest = found[1], found[2], found[3], found[4] or ""
        if guard and opcode != "bra":
            raise ValueError(f"the emulated card knows conditions of branches only, not of {text}")
        if opcode in ("bra", "bra.uni"):
            self._jumps[len(self._rows)] = rest
            register = self._operand(guard) if guard else -1
            self._add("bra", text, guard=register, wanted=int(not negated))
        elif opcode == "brx.idx":
            index, table = rest.split(", ")
            self._jumps[len(self._rows)] = table
            self._add("brx.idx", text, a=self._operand(index))
        elif opcode in ("call", "call.uni"):
            self._call(rest, text)
        else:
            self._plain(opcode, re.findall(r"\{[^}]*\}|\[[^\]]*\]|[^\s,]+", rest), text)

    def _call(self, rest: str, text: str) -> None:
        """Copy what is given, go there, copy what comes back."""
        found = re.fullmatch(r"(?:\((\w+)\), )?([\w$]+)(?:, \(([^)]*)\))?", rest)
        if found is None:
            raise ValueError(f"the emulated card does not know the call {text}")
        result, name, given = found[1], found[2], re.findall(r"\w+", found[3] or "")
        for formal, actual in zip(self._formals[name], given, strict=True):
            self._add("mov.b64", text, d=self._register(formal), a=self._operand(actual))
        self._jumps[len(self._rows)] = name
        self._add("call", text)
        if result:
            source = self._register(f"{name}:func_retval0")
            self._add("mov.b64", text, d=self._operand(result), a=source)

    def _plain(self, opcode: str, parts: list[str], text: str) -> None:
        """Add an instruction that leads nowhere else."""
        if opcode.startswith(("ld.param.", "st.param.")):
            to, source = (self._operand(part.strip("[]")) for part in parts)
            self._add("mov." + opcode.rpartition(".")[2], text, d=to, a=source)
        elif opcode in ("mov.b64", "mov.b32") and any(part[0] == "{" for part in parts):
            self._halves(int(opcode[-2:]) // 2, parts, text)
        elif re.search(r"\.v[24]\.", opcode):
            self._several(re.sub(r"\.v[24]", "", opcode), parts, text)
        elif opcode.startswith(("ld.", "st.", "atom.")):
            self._memory(opcode, parts, text)
        elif opcode == "shfl.sync.idx.b32":
            d, a, b, segment, members = parts
            if segment != "6175":  # eyas.lanes.vector.threads._SEGMENT: eights of threads
                raise ValueError(f"the emulated card knows shuffles of eight threads, not {text}")
            self._add("shfl.sync", text, **self._fields("dabc", [d, a, b, members]))
        elif opcode == "vote.sync.ballot.b32":
            self._add("vote.sync", text, **self._fields("dac", parts))
        elif opcode == "bar.warp.sync":
            self._add(opcode, text, **self._fields("c", parts))
        else:
            self._add(opcode, text, **self._fields("dabc"[: len(parts)], parts))

    def _fields(self, names: str, parts: list[str]) -> dict[str, int]:
        return {name: self._operand(part) for name, part in zip(names, parts, strict=True)}

    def _memory(self, opcode: str, parts: list[str], text: str, more: int = 0) -> None:
        place = next(part for part in parts if part[0] == "[").strip("[]")
        base, _, offset = place.partition("+")
        others = [part for part in parts if part[0] != "["]
        fields = self._fields("b" if opcode.startswith("st.") else "db"[: len(others)], others)
        self._add(opcode, text, a=self._operand(base), offset=int(offset or 0) + more, **fields)

    def _several(self, opcode: str, parts: list[str], text: str) -> None:
        """Load or store values next to each other."""
        size = int(re.sub(r"\D", "", opcode.rpartition(".")[2])) // 8
        values = next(re.findall(r"[^\s,{}]+", part) for part in parts if part[0] == "{")
        place = next(part for part in parts if part[0] == "[")
        turns = list(enumerate(values))
        if opcode.startswith("ld."):  # what overwrites the address comes last
            turns.sort(key=lambda turn: turn[1] == place.strip("[]").partition("+")[0])
        for turn, value in turns:
            self._memory(opcode, [value, place], text, turn * size)

    def _halves(self, size: int, parts: list[str], text: str) -> None:
        """Take a register apart: what LLVM writes to read the upper half of one."""
        halves = re.findall(r"[^\s,{}]+", parts[0])
        if parts[0][0] != "{" or len(halves) != 2:
            raise ValueError(f"the emulated card does not know {text}")
        low, high = halves
        if low != "_":
            self._add(f"cvt.u{size}.u{2 * size}", text, **self._fields("da", [low, parts[1]]))
        if high != "_":
            self._add(f"shr.u{2 * size}", text, **self._fields("dab", [high, parts[1], str(size)]))

    def _add(self, opcode: str, text: str, **fields: int) -> None:
        if opcode in CONTROL:
            code = CONTROL.index(opcode)
        else:
            code = self._codes.setdefault(opcode, len(CONTROL) + len(self._codes))
        fields = {"code": code, "guard": -1, "meet": -1, **fields}
        assert INSTRUCTION.names is not None
        self._rows.append(tuple(fields.get(name, 0) for name in INSTRUCTION.names))
        self._lines.append(text)

    def _operand(self, text: str) -> int:
        """Return the register of an operand; constants have registers, too."""
        if re.fullmatch(r"-?\d+", text):
            return self._register(int(text) & (1 << 64) - 1)
        if re.fullmatch(r"0[fd][0-9A-Fa-f]+", text):
            return self._register(int(text[2:], 16))
        if not re.fullmatch(r"[%$.\w]+", text):
            raise ValueError(f"the emulated card does not know the operand {text}")
        everywhere = text in _SPECIAL or any(text in names for names in self._offsets.values())
        if everywhere or text in self._formals[self._function]:
            return self._register(text)
        return self._register(f"{self._function}:{text}")

    def _register(self, name: str | int) -> int:
        """Return the number of a register: of a name, or of a constant's bits."""
        return self._registers.setdefault(name, len(self._registers))
