"""LLVM's modules of functions, kept on disk, so that an edit compiles only what it touches.

Three quarters of the time of compiling is numba's, which makes a module of each function; LLVM
optimises all that a kernel calls, and makes machine code of it, in the rest. A module is named by
what its function computes (`eyas.lanes.identity`) and by the types of its arguments.
"""

import itertools
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numba
from numba.core.codegen import JITCodeLibrary

from eyas.lanes.folder import kernel_folder, refusal
from eyas.lanes.identity import digest, language_hash
from eyas.lanes.machine_code import cpu
from eyas.lanes.targets import target_name
from eyas.lanes.trusted import read_trusted, touch, write_trusted
from eyas.lanes.vector.kinds import Lanes

SUFFIX = ".eym"  # End of the names of files of modules

_NUMBERS = itertools.count()  # Numbers of the modules that are not kept

_LOADED: dict[str, "Module"] = {}  # Modules read or made by this process, by name


class Module:
    """The module of a function; numba takes it for a library to be linked to those that call it."""

    _reload_init: frozenset[str] = frozenset()  # as numba's libraries have it

    def __init__(
        self,
        name: str,
        symbol: str,
        calls: tuple["Module", ...],
        code: bytes,
        returns: numba.types.Type,
    ) -> None:
        self.name = name
        self.symbol = symbol  # The function's name in the module
        self.calls = calls  # The modules of the kernels that it calls
        self.code = code  # LLVM's bitcode
        self.returns = returns  # numba's type of what the function returns

    def _ensure_finalized(self) -> None:
        """Be asked by numba, before a function that is not ours is linked to this."""

    def _get_module_for_linking(self) -> llvm.ModuleRef:
        """Return this module, with all that it calls, to a function that is not ours."""
        return _shared(linked(self))


def module_name(
    function: Callable[..., Any],
    kinds: tuple[numba.types.Type, ...],  # Types of its arguments
    made_of: str | None,  # Its `eyas.lanes.identity.identity`; None if it depends on more than that
) -> str | None:
    """Return the name of a function's module; None if it cannot be told from others."""
    told = [_told(kind) for kind in kinds]
    if made_of is None or any(" at 0x" in text for text in told):
        return None
    made_by = numba.__version__, llvmlite.__version__, cpu().triple, language_hash(), target_name()
    return f"{function.__name__}-{digest((made_of, *told))}-{digest(made_by)}"


def _told(kind: Any) -> str:  # noqa: ANN401  # numba's types have none
    """Return a text for a type, with the fields of named tuples, which numba leaves out."""
    if isinstance(kind, numba.types.BaseTuple):
        parts = ", ".join(map(_told, kind))
        of = getattr(kind, "instance_class", tuple)
        return f"{of.__module__}.{of.__qualname__}{getattr(of, '_fields', '')}({parts})"
    return f"*{_told(kind.dtype)}" if isinstance(kind, numba.types.CPointer) else str(kind)


def kept_module(name: str) -> Module | None:
    """Return a module that is kept, with those of all that it calls; None if one is missing."""
    if name not in _LOADED:
        path = kernel_folder() / f"{name}{SUFFIX}"
        found = read_trusted(path)
        if found is None:
            return None
        symbol, names, returns = found.header
        calls = [called for called in map(kept_module, names) if called is not None]
        if len(calls) < len(names):
            return None
        touch(path)
        code = bytes(found.pieces[0])
        _LOADED[name] = Module(name, symbol, tuple(calls), code, _type_of(returns))
    return _LOADED[name]


def module_of(
    library: JITCodeLibrary,  # numba's library of the function
    symbol: str,  # The function's name in it
    returns: numba.types.Type,  # Type of what the function returns
    name: str | None,  # From `module_name`
) -> Module:
    """Return the module of a function just compiled, and keep it if it has a name."""
    whole, calls = library._final_module.clone(), {}
    left, seen = list(library._linking_libraries), set()
    while left:
        called = left.pop(0)
        if isinstance(called, Module):
            calls[called.name] = called
        elif called not in seen:  # what numba compiles for itself
            seen.add(called)
            whole.link_in(_shared(called._final_module))
            left += called._linking_libraries
    for value in (*whole.functions, *whole.global_variables):
        if not value.is_declaration and value.name != symbol:
            value.linkage = "internal"  # numba's names for these differ between processes
    made = Module(
        name or f"{symbol} {next(_NUMBERS)}",
        symbol,
        tuple(calls.values()),
        whole.as_bitcode(),
        returns,
    )
    told = _as_json(returns)
    if name is not None and told is not None and all(one.name in _LOADED for one in made.calls):
        _LOADED[name] = made
        if not refusal():
            path = kernel_folder() / f"{name}{SUFFIX}"
            header = [symbol, [called.name for called in made.calls], told]
            write_trusted(path, header, [made.code])
    return made


def _shared(module: llvm.ModuleRef) -> llvm.ModuleRef:
    """Return a copy of a module whose functions may be in other copies too."""
    copy = module.clone()
    for function in copy.functions:
        if not function.is_declaration and function.linkage == llvm.Linkage.external:
            function.linkage = "linkonce_odr"
    return copy


def _as_json(kind: Any) -> Any:  # noqa: ANN401  # what JSON can tell
    """Return what tells a type that a kernel returns; None if it is not one of the usual ones."""
    if isinstance(kind, Lanes):
        return ["lanes", _as_json(kind.element)]
    if isinstance(kind, numba.types.CPointer):
        pointee = _as_json(kind.dtype)
        return None if pointee is None else ["pointer", pointee]
    if isinstance(kind, numba.types.Array):
        element = _as_json(kind.dtype)
        told = ["array", element, kind.ndim, kind.layout, not kind.mutable, kind.aligned]
        return told if isinstance(element, str) else None
    if isinstance(kind, numba.types.BaseTuple):
        of: Any = getattr(kind, "instance_class", tuple)
        parts = [_as_json(part) for part in kind]
        found = getattr(sys.modules.get(of.__module__), of.__qualname__, None)
        usual = found is of and None not in parts
        return [of.__module__, of.__qualname__, *parts] if usual else None
    return str(kind) if getattr(numba.types, str(kind), None) is kind else None


def _type_of(told: Any) -> Any:  # noqa: ANN401  # from JSON; numba's types have none
    """Return the type of `_as_json`."""
    if isinstance(told, str):
        return getattr(numba.types, told)
    if told[0] == "lanes":
        return Lanes(_type_of(told[1]))
    if told[0] == "pointer":
        return numba.types.CPointer(_type_of(told[1]))
    if told[0] == "array":
        dtype, dimensions, layout, readonly, aligned = told[1:]
        return numba.types.Array(_type_of(dtype), dimensions, layout, readonly, aligned=aligned)
    of = getattr(import_module(told[0]), told[1])
    return numba.types.BaseTuple.from_types(tuple(map(_type_of, told[2:])), of)


def linked(module: Module, into: llvm.ModuleRef | None = None) -> llvm.ModuleRef:
    """Return a module with those of all that it calls, linked into another one or a new one."""
    whole = llvm.parse_assembly("") if into is None else into
    found = {module.name: module}
    left = [module]
    while left:
        called = [other for other in left.pop().calls if other.name not in found]
        found.update((other.name, other) for other in called)
        left += called
    for one in found.values():
        whole.link_in(llvm.parse_bitcode(one.code))
    return whole
