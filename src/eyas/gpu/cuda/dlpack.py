"""DLPack: how libraries hand each other arrays; the structures are those of its `dlpack.h`."""

import atexit
import ctypes
from ctypes import (
    POINTER,
    Structure,
    c_char_p,
    c_int32,
    c_int64,
    c_uint8,
    c_uint16,
    c_uint64,
    c_void_p,
    py_object,
    pythonapi,
)
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from eyas.gpu.cuda.memory import CudaArray


_NAME = b"dltensor"

_CODES = {"i": 0, "u": 1, "f": 2, "c": 5, "b": 6}  # DLDataTypeCode by numpy's kind


class _Tensor(Structure):
    """DLManagedTensor, with the DLTensor that it begins with."""

    _fields_ = (
        ("data", c_void_p),
        ("device_type", c_int32),
        ("device_id", c_int32),
        ("ndim", c_int32),
        ("code", c_uint8),
        ("bits", c_uint8),
        ("lanes", c_uint16),
        ("shape", POINTER(c_int64)),
        ("strides", POINTER(c_int64)),
        ("byte_offset", c_uint64),
        ("manager_ctx", c_void_p),
        ("deleter", c_void_p),
    )


_given: dict[int, tuple[Any, ...]] = {}
"""What was handed to others, by the address of its structure, with all that this needs."""

_is_valid = ctypes.PYFUNCTYPE(ctypes.c_int, c_void_p, c_char_p)(("PyCapsule_IsValid", pythonapi))
_pointer = ctypes.PYFUNCTYPE(c_void_p, c_void_p, c_char_p)(("PyCapsule_GetPointer", pythonapi))
_new = ctypes.PYFUNCTYPE(py_object, c_void_p, c_char_p, c_void_p)(("PyCapsule_New", pythonapi))


# At the end of the interpreter others may let go when this module has no names any more, so these
# two bring all that they need, and stay.


@ctypes.PYFUNCTYPE(None, c_void_p)
def _delete(tensor: int, given: dict[int, Any] = _given) -> None:
    given.pop(tensor, None)


@ctypes.PYFUNCTYPE(None, c_void_p)
def _drop(
    capsule: int,
    given: dict[int, Any] = _given,
    name: bytes = _NAME,
    is_valid: Any = _is_valid,  # noqa: ANN401
    pointer: Any = _pointer,  # noqa: ANN401
) -> None:
    """Let go of an array whose capsule nobody has opened."""
    if is_valid(capsule, name):
        given.pop(pointer(capsule, name), None)


for _kept in (_delete, _drop):
    pythonapi.Py_IncRef(py_object(_kept))


@atexit.register
def _let_go() -> None:
    """Have others call nothing that is in Python: libraries may end after it."""
    for tensor, *_ in _given.values():
        tensor.deleter = None


def capsule_of(array: "CudaArray", device: tuple[int, int]) -> Any:  # noqa: ANN401
    """Return a capsule named `dltensor`; the array lives until its receiver deletes it.

    Args:
        array: The array.
        device: DLPack's type and number of its device.

    Raises:
        BufferError: DLPack has no such elements.
    """
    kind: np.dtype[Any] = array.dtype
    if kind.kind not in _CODES or not kind.isnative:
        raise BufferError(f"DLPack has no elements of type {kind}")
    counts = c_int64 * max(array.ndim, 1)
    shape = counts(*array.shape)
    strides = counts(*[step // kind.itemsize for step in array.strides])
    tensor = _Tensor(
        array.address, *device, array.ndim, _CODES[kind.kind], 8 * kind.itemsize, 1,
        shape, strides, 0, None, ctypes.cast(_delete, c_void_p),
    )  # fmt: skip
    address = ctypes.addressof(tensor)
    _given[address] = (tensor, shape, strides, array)
    return _new(address, _NAME, ctypes.cast(_drop, c_void_p))
