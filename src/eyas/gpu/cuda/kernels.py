"""Kernels on a graphics processor, compiled by the driver."""

import ctypes
import threading
import weakref
from ctypes import byref, c_int, c_void_p
from typing import Any, NamedTuple

from eyas.gpu.cuda.bundles import CudaBundle
from eyas.gpu.cuda.code import Ptx, ptx_code
from eyas.gpu.cuda.context import Context
from eyas.gpu.cuda.driver import CudaError
from eyas.lanes.calls import ParallelCall

_LOCAL_BYTES, _REGISTERS = 3, 4  # CU_FUNC_ATTRIBUTE_LOCAL_SIZE_BYTES and _NUM_REGS

_ERROR_LOG, _ERROR_LOG_SIZE = 5, 6  # CU_JIT_ERROR_LOG_BUFFER and _SIZE_BYTES


class Function(NamedTuple):
    """A kernel, compiled for a card."""

    handle: c_void_p
    name: str
    registers: int  # Of a thread
    local: int  # Memory of a thread beside its registers [bytes]


class Functions:
    """The kernels of a context, each compiled at its first call.

    Args:
        context: The context.
    """

    def __init__(self, context: Context) -> None:
        self._context = context
        self._lock = threading.Lock()
        self._of_call: weakref.WeakKeyDictionary[ParallelCall, dict[Any, Function]]
        self._of_call = weakref.WeakKeyDictionary()
        self._loaded: dict[Ptx, Function] = {}

    def function(
        self, call: ParallelCall, bundles: tuple[CudaBundle, ...], threads: int
    ) -> Function:
        """Return a kernel for bundles of these kinds; see `eyas.lanes.device.Device.launch`."""
        kinds = tuple([bundle.kind for bundle in bundles])
        known = self._of_call.get(call)
        found = None if known is None else known.get((kinds, threads))
        if found is not None:
            return found
        types = tuple([bundle.types for bundle in bundles])
        ptx = ptx_code(call, types, kinds, threads)
        with self._lock:
            if ptx not in self._loaded:
                self._loaded[ptx] = function_of(self._context, ptx, call.function.__name__)
            self._of_call.setdefault(call, {})[kinds, threads] = self._loaded[ptx]
        return self._loaded[ptx]


def function_of(context: Context, ptx: Ptx, name: str) -> Function:
    """Have the driver compile a kernel, or find it in its cache.

    Args:
        context: Where it is to run.
        ptx: The kernel.
        name: Its name for people.

    Raises:
        CudaError: The driver refuses it; its log is in the message.
    """
    log = ctypes.create_string_buffer(8192)
    options = (c_int * 2)(_ERROR_LOG, _ERROR_LOG_SIZE)
    values = (c_void_p * 2)(ctypes.addressof(log), len(log))
    text = ctypes.create_string_buffer(ptx.text)  # with a zero at its end
    module, handle = c_void_p(), c_void_p()
    doing = f"compiling {name} for {context.name}"
    with context.current() as call:
        try:
            call("cuModuleLoadDataEx", byref(module), text, 2, options, values, doing=doing)
        except CudaError as error:
            said = log.value.decode(errors="replace").strip()
            raise CudaError(f"{error}\n{said}" if said else str(error), error.code) from None
        call("cuModuleGetFunction", byref(handle), module, ptx.entry.encode(), doing=doing)
        registers, local = c_int(), c_int()
        call("cuFuncGetAttribute", byref(registers), _REGISTERS, handle)
        call("cuFuncGetAttribute", byref(local), _LOCAL_BYTES, handle)
    return Function(handle, name, registers.value, local.value)
