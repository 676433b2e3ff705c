"""How numba compiles kernels: to LLVM's modules, of which `eyas.lanes.machine_code` makes code.

numba itself would optimise each function with everything that it calls, make machine code of it,
and keep that on disk, though most functions of a kernel are only inlined into others. Here each
function becomes a module once; those of a kernel and of all that it calls are linked and optimised
together.

Only this module, `eyas.lanes.front_end` and `eyas.lanes.vector` use parts of numba that it does not
document.
"""

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba.core.callconv import CPUCallConv
from numba.core.compiler import compile_extra
from numba.core.compiler_lock import global_compiler_lock
from numba.core.funcdesc import FunctionDescriptor
from numba.core.registry import cpu_target
from numba.extending import models, register_model

from eyas.lanes import operations as _fields  # noqa: F401  # registers them with numba
from eyas.lanes.front_end import SETTINGS, Compiler, Library, flags, typing
from eyas.lanes.identity import identity
from eyas.lanes.interrupts import let_in
from eyas.lanes.machine_code import MachineCode, optimised
from eyas.lanes.modules import Module, kept_module, linked, module_name, module_of
from eyas.lanes.targets import current_context, for_threads, target_name
from eyas.lanes.vector import operators as _operators  # noqa: F401  # registers them with numba

Kind = Any  # One of numba's types


class _Overload(NamedTuple):
    """A function compiled for arguments of certain types."""

    signature: Any
    described: Any  # numba's description of the function: its name and types
    module: Module


@global_compiler_lock
def _overload(
    function: Callable[..., Any],  # A plain function
    kinds: tuple[Kind, ...],  # The types
    inline: bool | None,  # See `eyas.lanes.jit.kernel`
    made_of: str | None,  # Its `eyas.lanes.identity.identity`; None if it depends on more than that
) -> _Overload:
    """Return a function for arguments of some types: as it is kept, or compiled."""
    name = module_name(function, kinds, made_of)
    kept = None if name is None else kept_module(name)
    if kept is None:
        return _compile(function, kinds, inline, name)
    signature = numba.core.typing.signature(kept.returns, *kinds)
    described = FunctionDescriptor(
        native=True,
        modname=function.__module__,
        qualname=function.__qualname__,
        unique_name=kept.name,
        doc="",
        typemap=None,
        restype=kept.returns,
        calltypes=None,
        args=tuple(inspect.signature(function).parameters),
        kws=(),
        mangler=lambda *_, **__: kept.symbol,
        argtypes=kinds,
        inline=inline is True,
    )
    return _Overload(signature, described, kept)


def _compile(
    function: Callable[..., Any], kinds: tuple[Kind, ...], inline: bool | None, name: str | None
) -> _Overload:
    target = current_context()
    library = Library(target.codegen(), function.__qualname__, name and name.split("-")[1])
    with _exceptions_without_places():
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
    symbol = made.fndesc.llvm_func_name
    if inline is False:
        library._final_module.get_function(symbol).add_function_attribute("noinline")
    module = module_of(library, symbol, made.signature.return_type, name)
    return _Overload(made.signature, made.fndesc, module)


@contextmanager
def _exceptions_without_places() -> Iterator[None]:
    """Compile exceptions without the file and line where they are raised.

    A kernel only says that it has raised one. numba would put the path of each file into machine
    code, which ships: the folders of the machine that made it. The caller holds the compiler lock.
    """
    of_numba = CPUCallConv.build_excinfo_struct

    def without_place(self: Any, kind: Any, values: Any, *_: object) -> Any:  # noqa: ANN401  # numba's
        return of_numba(self, kind, values, None, None)

    CPUCallConv.build_excinfo_struct = without_place
    try:
        yield
    finally:
        CPUCallConv.build_excinfo_struct = of_numba


class KernelType(numba.types.Callable, numba.types.Opaque):  # type: ignore[misc]
    """The type of a kernel in the kernels that call it."""

    def __init__(
        self,
        function: Callable[..., Any],
        made_of: str | None,
        *,
        inline: bool | None,
        double: bool,
        threads: Callable[..., Any] | None,
        apart: bool,
    ) -> None:
        self._function, self._made_of, self._threads = function, made_of, threads
        self._inline, self._double, self._apart = inline, double, apart
        self._parameters = inspect.signature(function)
        self._overloads: dict[tuple[str, tuple[Kind, ...]], _Overload] = {}
        name = f"{function.__module__}.{function.__qualname__}"
        super().__init__(f"kernel({name} at {id(function):#x})")

    def get_call_type(
        self, typing_context: object, args: Iterable[Kind], kws: dict[str, Kind]
    ) -> object:
        """Return the signature of a call, after compiling the kernel for it."""
        let_in()
        given = self._parameters.bind(*args, **dict(kws)).arguments
        kinds = tuple(
            _widened(given[name], self._double)
            if name in given
            else numba.types.Omitted(parameter.default)
            for name, parameter in self._parameters.parameters.items()
        )
        key = target_name(), kinds
        if key not in self._overloads:
            function, inline = self._function, self._inline
            if for_threads():
                function, inline = self._threads or function, False if self._apart else inline
            made = _overload(function, kinds, inline, self._made_of)
            current_context().insert_user_function(made, made.described, (made.module,))
            self._overloads[key] = made
        return self._overloads[key].signature.replace(pysig=self._parameters)

    def get_call_signatures(self) -> tuple[list[object], bool]:
        """Return the signatures compiled so far, and that there may be others."""
        return [made.signature for made in self._overloads.values()], True

    def get_impl_key(self, signature: Any) -> object:  # noqa: ANN401  # numba's signature
        """Return what identifies the compiled function."""
        return self._overloads[target_name(), signature.args]


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


def entry_code(
    function: Callable[..., Any], bundles: Sequence[Kind], entry: str, *, over_workers: bool
) -> MachineCode:
    """Return the machine code of a function and of all that it calls; arguments as below."""
    return optimised(entry_module(function, bundles, entry, over_workers=over_workers), entry)


def entry_module(
    function: Callable[..., Any], bundles: Sequence[Kind], entry: str, *, over_workers: bool
) -> llvm.ModuleRef:
    """Return a module of a function and of all that it calls.

    Args:
        function: A plain function that returns nothing, see `eyas.lanes.calls.CompiledCall`.
        bundles: The types of what it is called with.
        entry: Name of the function in C. It is given the address of a table with the addresses of
            the bundles, and two numbers, which reach `function` if it works `over_workers`. It
            returns 0, or another number if `function` raised an exception.
        over_workers: See `eyas.lanes.calls.CompiledCall`.
    """
    made_of = identity(function) if function.__closure__ is None else None
    first = (numba.types.intp, numba.types.intp) if over_workers else ()
    made = _overload(function, (*first, *map(_passed, bundles)), None, made_of)
    let_in()
    module = linked(made.module, _entry(made, entry, len(first))._final_module)
    let_in()
    return module


def _passed(bundle: Kind) -> Kind:
    """Return the type by which a function gets a bundle: by value, unless it is a named tuple."""
    named = isinstance(bundle, numba.types.BaseNamedTuple)
    return numba.types.CPointer(bundle) if named else bundle


def _entry(made: _Overload, entry: str, numbers: int) -> Library:
    """Return the function that C can call; `numbers` of its own are handed on before bundles."""
    target = current_context()
    library = Library(target.codegen(), entry)
    module = target.create_module(entry)
    described, convention = made.described, target.call_conv
    kind = convention.get_function_type(described.restype, described.argtypes)
    callee = ir.Function(module, kind, described.llvm_func_name)
    number, address = ir.IntType(64), ir.IntType(8).as_pointer()
    c_type = ir.FunctionType(ir.IntType(32), [address.as_pointer(), number, number])
    called = ir.Function(module, c_type, entry)
    builder = ir.IRBuilder(called.append_basic_block())
    given = list(called.args[1 : 1 + numbers])
    for place, bundle in enumerate(described.argtypes[numbers:]):
        slot = builder.load(builder.gep(called.args[0], [number(place)]))
        model = target.data_model_manager[bundle]
        if isinstance(bundle, numba.types.CPointer):
            given.append(builder.bitcast(slot, model.get_value_type()))
        else:
            pointer = builder.bitcast(slot, model.get_data_type().as_pointer())
            given.append(model.load_from_data_pointer(builder, pointer))
    status, _ = convention.call_function(
        builder, callee, described.restype, described.argtypes, given
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
