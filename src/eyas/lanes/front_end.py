"""numba's compiler without what kernels do not need, which was half of the time of compiling."""

import math
import re
from functools import cache
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from numba import types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder, Flags
from numba.core.funcdesc import default_mangler
from numba.core.registry import cpu_target
from numba.core.typed_passes import NopythonRewrites
from numba.core.typing import Context
from numba.core.untyped_passes import InlineClosureLikes

from eyas.lanes import elementary

Kind = Any  # One of numba's types

# Kernels allocate nothing, so they need no reference counting of arrays (`_nrt`). It costs two
# atomic operations for each array passed on, which is slow when threads share the arrays: pictures
# took three times as long.
SETTINGS = {"error_model": "numpy", "fastmath": False, "_nrt": False}

_INNER = {"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


_OWN = {
    **{id(getattr(math, name)): getattr(elementary, name) for name in elementary.OF_MATH},
    **{id(getattr(np, name)): getattr(elementary, own) for own, name in elementary.OF_NUMPY},
}
"""What kernels call instead of functions of `math` and numpy, which are those of the C library."""


class Library(JITCodeLibrary):  # type: ignore[misc]  # numba has no types
    """The module of one function, which is linked into others but never made machine code.

    Args:
        codegen: numba's generator of code.
        name: Of the function.
        unique: What tells its symbol from those of other functions, the same in every process;
            None: a number.
    """

    def __init__(self, codegen: Any, name: str, unique: str | None = None) -> None:  # noqa: ANN401
        super().__init__(codegen, name)
        self.unique = unique

    def finalize(self) -> None:
        """Make nothing of it."""
        self._finalized = True

    def add_linking_library(self, library: JITCodeLibrary) -> None:
        """Note a module that this one calls."""
        self._linking_libraries.append(library)

    def _optimize_functions(self, ll_module: llvm.ModuleRef) -> None:
        # All is optimised at the end, in no more time and to no worse code.
        ll_module.data_layout = self._codegen._data_layout


class _Flags(Flags):  # type: ignore[misc]
    """Settings that numba need not compare, as it does at each operator: that took a tenth of the
    time of compiling.
    """

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        return self is other or (not isinstance(other, _Flags) and super().__eq__(other))

    def __hash__(self) -> int:
        return id(self)

    def copy(self) -> "_Flags":
        return self


@cache
def flags(*, inline: bool) -> _Flags:
    """Return the settings of a function, which LLVM inlines into its callers if told so."""
    made = _Flags()
    cpu_target.options.parse_as_flags(made, {**SETTINGS, **_INNER, "forceinline": inline})
    made.no_compile = True
    return made


def _symbol(
    name: str,
    kinds: tuple[Kind, ...],
    *,
    abi_tags: tuple[str, ...] = (),
    uid: int | str | None = None,
) -> str:
    """Return a function's symbol; numba's own tell all types, in up to three thousand letters."""
    if isinstance(uid, str):
        return re.sub(r"\W", "_", f"{name}.{uid}")
    return str(default_mangler(name, kinds, abi_tags=abi_tags, uid=uid))


class Compiler(CompilerBase):  # type: ignore[misc]
    """numba's compiler without what kernels do not need: a tenth of the time."""

    _LEFT_OUT = (InlineClosureLikes, NopythonRewrites)
    """For functions inside functions, and for sums of whole arrays."""

    def define_pipelines(self) -> list[Any]:
        """Return numba's own passes without some."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [step for step in passes.passes if step[0] not in self._LEFT_OUT]
        passes.finalize()
        return [passes]

    def _compile_bytecode(self) -> Any:  # noqa: ANN401  # numba's result
        if self.state.library.unique is not None:
            self.state.func_id.unique_id = self.state.library.unique
            self.state.targetctx.mangler = _symbol  # of a copy that is this compiler's own
        return super()._compile_bytecode()


class _Typing(Context):  # type: ignore[misc]
    """numba's knowledge of types, shared with it, but with elementary functions of our own, and the
    signatures of operators remembered.

    numba tries a dozen rules at each `+`: a fifth of the time of compiling.
    """

    __slots__ = ("_known",)  # all else is the very dictionary of numba's own

    def __init__(self) -> None:
        self.__dict__ = vars(cpu_target.typing_context)  # type: ignore[misc]  # no slot
        self._known: dict[tuple[int, tuple[Kind, ...]], tuple[Kind, Any, Any]] = {}

    def resolve_value_type(self, val: object) -> Kind:
        """Return the type of a global value."""
        return super().resolve_value_type(_OWN.get(id(val), val))

    def resolve_getattr(self, typ: Kind, attr: str) -> Kind:
        """Return the type of an attribute, such as `sin` of `math`."""
        own = _OWN.get(id(getattr(typ.pymod, attr, None))) if type(typ) is types.Module else None
        return super().resolve_getattr(typ, attr) if own is None else self.resolve_value_type(own)

    def resolve_function_type(
        self, func: Kind, args: tuple[Kind, ...], kws: dict[str, Kind]
    ) -> Any:  # noqa: ANN401  # numba's signature
        """Return the signature of a call."""
        if kws or type(func) is not types.Function:
            return super().resolve_function_type(func, args, kws)
        key = id(func), args
        if key not in self._known:
            signature = super().resolve_function_type(func, args, kws)
            # The function is kept, so that no other gets its `id`.
            self._known[key] = func, signature, func.get_impl_key(signature)
        _, signature, implementation = self._known[key]
        # What numba generates code with is noted in the function, which others resolve too, each
        # with code of its own, as numba with other settings does.
        func._impl_keys[signature.args] = implementation
        return signature


@cache
def typing() -> Context:
    """Return the knowledge of types by which kernels are compiled."""
    return _Typing()
