"""What identifies a kernel: what it computes, not how its file looks.

The identity of a kernel is a digest of its syntax (`eyas.lanes.syntax`), of the values that it
reads from its module, and the same of all that it calls. So a comment changes nothing, a constant
changes only the kernels that read it, and nothing must be raised by hand.
"""

import enum
import types
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from eyas.lanes.syntax import INDEX, syntax_of

LANGUAGE = (
    "bundles.py",
    "compilation.py",
    "elementary",
    "front_end.py",
    "intrinsics.py",
    "machine_code.py",
    "modules.py",
    "operations.py",
    "targets.py",
    "vector",
)
"""Files and folders of this room that decide what a kernel is compiled to, beside the kernel."""

_ROOM = Path(__file__).parent

_PLAIN = (type(None), bool, int, float, complex, str, bytes)


def language_files() -> list[Path]:
    """Return the files of `LANGUAGE`."""
    named = [_ROOM / name for name in LANGUAGE]
    return sorted(
        file for path in named for file in (path.rglob("*.py") if path.is_dir() else [path])
    )


@cache
def language_hash() -> str:
    """Return a digest of the language of kernels, the name of the folder of compiled ones."""
    said = [f"{file.name}:{syntax_of(file)[''].digest}" for file in language_files()]
    INDEX.keep()
    return sha256("\n".join(said).encode()).hexdigest()[:16]


def identity(function: Callable[..., Any]) -> str:
    """Return a text that identifies what a function computes, kernel or not."""
    told = "\n".join(_Closure(function).told())
    INDEX.keep()
    return sha256(told.encode()).hexdigest()


def code_name(
    function: Callable[..., Any],  # A compiled function
    kinds: Iterable[str] = (),  # Of its bundles, see `eyas.lanes.bundles.PackedBundle`
) -> str:
    """Return the name of a kernel's code, `<name of function>-<digest of it>-<digest of kinds>`;
    without kinds its beginning.
    """
    name = function.__qualname__.rpartition(".")[2]
    begin = f"{name}-{digest((name, identity(function)))}"
    return f"{begin}-{digest(kinds)}" if kinds else begin


def entry_of(name: str) -> str:
    """Return the name of the function in a kernel's code: without what made it, so that others make
    the same bytes.
    """
    return name.replace("-", "_")


def digest(parts: Iterable[str]) -> str:
    """Return a short digest of some texts."""
    return sha256("\0".join(parts).encode()).hexdigest()[:16]


class _Closure:
    """A function and all that it calls."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._numbers: dict[object, int] = {}
        self._left: list[Any] = []
        self._number(function)

    def told(self) -> Iterator[str]:
        """Yield what is known of each function, in a fixed order."""
        for kernel in self._left:  # which grows meanwhile
            function = getattr(kernel, "py_func", kernel)
            yield f"{function.__module__}.{function.__qualname__} {_compiled_as(kernel)}"
            yield self._described(function.__defaults__)
            if getattr(kernel, "threads", None) is not None:
                yield f"threads {self._described(kernel.threads)}"
            yield from self._own(function)

    def _number(self, function: Any) -> int:  # noqa: ANN401  # a kernel or a function
        plain = getattr(function, "py_func", function)
        if plain not in self._numbers:
            self._numbers[plain] = len(self._numbers)
            self._left.append(function)
        return self._numbers[plain]

    def _own(self, function: types.FunctionType) -> Iterator[str]:
        """Yield a function's syntax, and the values of the names that it reads."""
        code = function.__code__
        try:
            written = syntax_of(Path(code.co_filename)).get(code.co_qualname)
        except (OSError, SyntaxError, ValueError):
            written = None
        if written is None:  # made by `exec`, or of a lambda
            yield repr(code.co_code) + repr([c for c in code.co_consts if isinstance(c, _PLAIN)])
            names: Iterable[str] = sorted(code.co_names)
        else:
            yield written.digest
            names = written.names
        for name in names:
            root, _, attribute = name.partition(".")
            if root in function.__globals__:  # else it is a local name
                value = function.__globals__[root]
                known = getattr(value, attribute, None) if attribute else value
                yield f"{name} {self._described(known)}"

    def _described(self, value: Any) -> str:  # noqa: ANN401  # anything that a module holds
        """Return a text that differs where a value does, and is the same in every process."""
        if hasattr(value, "py_func") or (
            isinstance(value, types.FunctionType) and not _of_language(value)
        ):
            return f"function {self._number(value)}"
        if isinstance(value, enum.Enum):
            return f"{type(value).__qualname__}.{value.name} {self._described(value.value)}"
        if isinstance(value, _PLAIN):
            return f"{type(value).__name__} {value!r}"
        if isinstance(value, np.generic | np.ndarray):
            return f"{value.dtype.descr} {value.shape} {sha256(value.tobytes()).hexdigest()}"
        if isinstance(value, np.dtype):
            return f"{value.descr} {value.itemsize} {value.isalignedstruct}"
        if isinstance(value, tuple | list | frozenset | set):
            parts = [self._described(part) for part in value]
            ordered = parts if isinstance(value, tuple | list) else sorted(parts)
            return f"{type(value).__qualname__}({', '.join(ordered)})"
        if isinstance(value, dict):
            parts = [f"{self._described(key)}: {self._described(value[key])}" for key in value]
            return f"{{{', '.join(parts)}}}"
        if isinstance(value, type):
            return self._of_class(value)
        name = getattr(value, "__qualname__", "") or getattr(value, "__name__", "")
        return (
            f"{type(value).__qualname__} {getattr(value, '__module__', '')} {name or _told(value)}"
        )

    def _of_class(self, kind: type) -> str:
        """Return what kernels may know of a class."""
        name = f"{kind.__module__}.{kind.__qualname__}"
        fields = getattr(kind, "_fields", None)
        if fields is not None:
            return f"{name}{fields} {self._described(getattr(kind, '_field_defaults', None))}"
        if issubclass(kind, enum.Enum):
            return f"{name} {[(one.name, self._described(one.value)) for one in kind]}"
        return name


def _compiled_as(kernel: Any) -> str:  # noqa: ANN401  # a kernel or a function
    return f"{getattr(kernel, '_inline', None)} {getattr(kernel, '_double', None)}"


def _of_language(function: types.FunctionType) -> bool:
    """Return whether a function belongs to the language of kernels, whose hash names the folder."""
    names = {"eyas.lanes." + name.removesuffix(".py") for name in LANGUAGE}
    return any(
        function.__module__ == one or function.__module__.startswith(f"{one}.") for one in names
    )


def _told(value: object) -> str:
    """Return what tells an object from others: an `Intrinsic` has names, other things a `repr`."""
    names = [getattr(value, name, None) for name in ("_module", "_name")]
    text = repr(names) if all(names) else repr(value)
    return text.partition(" at 0x")[0]
