"""How numba compiles kernels: to LLVM's modules, of which `eyas.lanes.machine_code` makes code.

numba itself would optimise each function with everything that it calls, make machine code of it,
and keep that on disk, though most functions of a kernel are only inlined into others. Here each
function becomes a module once; those of a kernel and of all that it calls are linked and optimised
together.

Only this module, `eyas.lanes.front_end` and `eyas.lanes.vector` use parts of numba that it does not
document.
"""

import inspect
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba.core.compiler import compile_extra
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.extending import models, register_model

from eyas.core.interrupts import let_in
from eyas.lanes import pointers as _pointers  # noqa: F401  # registers fields with numba
from eyas.lanes.front_end import SETTINGS, Compiler, Library, flags, typing
from eyas.lanes.machine_code import MachineCode, optimised
from eyas.lanes.vector import operators as _operators  # noqa: F401  # registers them with numba

__all__ = [
    "KernelType",
    "caller_from_python",
    "entry_code",
    "entry_module",
    "intrinsic_type",
    "kinds_of",
    "size_of",
]

Kind = Any
"""One of numba's types."""


class _Overload(NamedTuple):
    """A function compiled for arguments of certain types."""

    signature: Any
    described: Any
    """numba's description of the function: its name and types."""
    libraries: tuple[Any, ...]
    """Its module and those of all that it calls."""


@global_compiler_lock
def _compile(
    function: Callable[..., Any], kinds: tuple[Kind, ...], *, inline: bool | None
) -> _Overload:
    target = cpu_target.target_context
    library = Library(target.codegen(), function.__qualname__)
    made = compile_extra(
        typing(),
        target,
        function,
        kinds,
        None,
        flags(inline=inline is True),
        {},
        library=library,
        pipeline_class=Compiler,
    )
    if inline is False:
        own = library._final_module.get_function(made.fndesc.llvm_func_name)
        own.add_function_attribute("noinline")
    return _Overload(made.signature, made.fndesc, _with_all_that_it_calls(library))


def _with_all_that_it_calls(library: Any) -> tuple[Any, ...]:  # noqa: ANN401  # numba's library
    found = {library: None}
    left = [library]
    while left:
        called = [other for other in left.pop()._linking_libraries if other not in found]
        found.update(dict.fromkeys(called))
        left += called
    return tuple(found)


class KernelType(numba.types.Callable, numba.types.Opaque):  # type: ignore[misc]
    """The type of a kernel in the kernels that call it."""

    def __init__(self, function: Callable[..., Any], *, inline: bool | None, double: bool) -> None:
        self._function, self._inline, self._double = function, inline, double
        self._parameters = inspect.signature(function)
        self._overloads: dict[tuple[Kind, ...], _Overload] = {}
        name = f"{function.__module__}.{function.__qualname__}"
        super().__init__(f"kernel({name} at {id(function):#x})")

    def get_call_type(self, context: object, args: Iterable[Kind], kws: dict[str, Kind]) -> object:
        """Return the signature of a call, after compiling the kernel for it."""
        let_in()
        given = self._parameters.bind(*args, **dict(kws)).arguments
        kinds = tuple(
            _widened(given[name], self._double)
            if name in given
            else numba.types.Omitted(parameter.default)
            for name, parameter in self._parameters.parameters.items()
        )
        if kinds not in self._overloads:
            made = _compile(self._function, kinds, inline=self._inline)
            cpu_target.target_context.insert_user_function(made, made.described, made.libraries)
            self._overloads[kinds] = made
        return self._overloads[kinds].signature.replace(pysig=self._parameters)

    def get_call_signatures(self) -> tuple[list[object], bool]:
        """Return the signatures compiled so far, and that there may be others."""
        return [made.signature for made in self._overloads.values()], True

    def get_impl_key(self, signature: Any) -> object:  # noqa: ANN401  # numba's signature
        """Return what identifies the compiled function."""
        return self._overloads[signature.args]


register_model(KernelType)(models.OpaqueModel)


def _widened(kind: Kind, double: bool) -> Kind:
    """Return one type for all signed whole numbers, and float64 for all numbers if `double`.

    For the calls `f(0)`, `f(1)` and `f(i)` in other kernels numba would compile `f` three times,
    and once more if `i` has 32 bits.
    """
    kind = numba.types.unliteral(kind)
    if double and isinstance(kind, numba.types.Number):
        return numba.types.float64
    signed = isinstance(kind, numba.types.Integer) and kind.signed
    return numba.types.int64 if signed else kind


def entry_code(function: Callable[..., Any], kinds: tuple[Kind, ...], entry: str) -> MachineCode:
    """Return the machine code of a function and of all that it calls; arguments as below."""
    return optimised(entry_module(function, kinds, entry), entry)


def entry_module(
    function: Callable[..., Any], kinds: tuple[Kind, ...], entry: str
) -> llvm.ModuleRef:
    """Return a module of a function and of all that it calls.

    Args:
        function: A plain function that returns nothing.
        kinds: The types of its arguments.
        entry: Name of the function in C, which returns 0, or another number if `function` raised
            an exception.
    """
    made = _compile(function, kinds, inline=None)
    let_in()
    library = _entry(made, entry)
    module = library._final_module
    for called in made.libraries:
        module.link_in(_shared(called))
    let_in()
    return module


def kinds_of(bundles: Iterable[tuple[Any, ...]]) -> tuple[Kind, ...]:
    """Return the types of a kernel's arguments: pointers to bundles in a table, and two numbers."""
    pointers = [numba.types.CPointer(numba.typeof(bundle)) for bundle in bundles]
    table = numba.types.CPointer(numba.types.Tuple(pointers))
    return table, numba.types.intp, numba.types.intp


def _shared(library: Any) -> llvm.ModuleRef:  # noqa: ANN401  # numba's library
    """Return a copy of a library's module whose functions may be in other copies too."""
    module = library._final_module.clone()
    for function in module.functions:
        if not function.is_declaration and function.linkage == llvm.Linkage.external:
            function.linkage = "linkonce_odr"
    return module


def _entry(made: _Overload, entry: str) -> Library:
    """Return the function that C can call."""
    context = cpu_target.target_context
    library = Library(context.codegen(), entry)
    module = context.create_module(entry)
    described, convention = made.described, context.call_conv
    kind = convention.get_function_type(described.restype, described.argtypes)
    callee = ir.Function(module, kind, described.llvm_func_name)
    arguments = [context.get_value_type(kind) for kind in described.argtypes]
    called = ir.Function(module, ir.FunctionType(ir.IntType(32), arguments), entry)
    builder = ir.IRBuilder(called.append_basic_block())
    status, _ = convention.call_function(
        builder, callee, described.restype, described.argtypes, called.args
    )
    builder.ret(status.code)
    library.add_ir_module(module)
    return library


def intrinsic_type(made: object) -> Kind:
    """Return the type of an operation that numba's `intrinsic` has made."""
    context = cpu_target.typing_context
    context.refresh()
    return context.resolve_value_type(made)


def size_of(kind: Kind) -> int:
    """Return the size of a value in memory [bytes]."""
    context = cpu_target.target_context
    context.refresh()
    size: int = context.get_abi_sizeof(context.get_data_type(kind))
    return size


def caller_from_python(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function compiled for calls from Python, in numba's own way.

    It is not kept on disk, where numba would pickle it.
    """
    compiled: Callable[..., Any] = numba.njit(**SETTINGS)(function)
    return compiled
