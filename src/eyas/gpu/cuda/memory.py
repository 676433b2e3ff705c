"""Arrays in the memory of a graphics processor, which other libraries can share."""

import atexit
import ctypes
import math
from collections.abc import Sequence
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
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.gpu.cuda.context import Context, Memory
from eyas.gpu.cuda.order import CudaEvent

# DLPack: how libraries hand each other arrays; the structures are those of its `dlpack.h`.

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


_LEGACY_STREAM = 1  # The legacy default stream, as `__cuda_array_interface__` and DLPack number it


class CudaArray:
    """A C-contiguous array in the memory of a graphics processor.

    `torch.from_dlpack(array)` and `torch.as_tensor(array, device="cuda")` share its memory, and so
    do rows, `array[first:last]`, and `reshape`. Nothing is read from it here: see
    `CudaDevice.read`.

    Attributes:
        address: Of its first element, in the memory of the device.
        shape: Its shape.
        dtype: Type of its elements.
        words: What `eyas.gpu.cuda.bundles` knows of it.
    """

    __slots__ = ("_stand_in", "address", "dtype", "memory", "shape", "words")

    def __init__(
        self, memory: Memory, address: int, shape: tuple[int, ...], dtype: np.dtype[Any]
    ) -> None:
        self.memory, self.address, self.shape, self.dtype = memory, address, shape, dtype
        self._stand_in: NDArray[Any] | None = None
        self.words: tuple[list[Any], list[object]] | None = None

    @property
    def context(self) -> Context:
        """Where it is."""
        return self.memory.context

    @property
    def ndim(self) -> int:
        """Number of its axes."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of its elements."""
        return math.prod(self.shape)

    @property
    def nbytes(self) -> int:
        """Its size [bytes]."""
        return self.size * self.dtype.itemsize

    @property
    def strides(self) -> tuple[int, ...]:
        """Distances of neighbours along each axis [bytes]."""
        return self.stand_in.strides

    @property
    def stand_in(self) -> NDArray[Any]:
        """An array of numpy that says it is at the address, which is no address of this processor:
        for numpy's arithmetic of shapes and for the layout of bundles; to read it is a crash.
        """
        if self._stand_in is None:
            whole = np.asarray(_Place(self.address, self.shape, self.dtype.itemsize))
            self._stand_in = whole.view(self.dtype)
        return self._stand_in

    def __len__(self) -> int:
        return len(self.stand_in)

    def __repr__(self) -> str:
        return f"CudaArray({self.shape}, {self.dtype}, on {self.context.name})"

    def __getitem__(self, rows: slice) -> "CudaArray":
        if not isinstance(rows, slice) or rows.step not in (None, 1):
            raise TypeError("an array on a graphics processor gives rows only: array[first:last]")
        return self._like(self.stand_in[rows])

    def __array__(self, *_: object, **__: object) -> NDArray[Any]:
        raise TypeError(
            "an array on a graphics processor is read by its device: device.read(array)"
        )

    def reshape(self, *shape: Any) -> "CudaArray":  # noqa: ANN401  # as numpy has it
        """Return the same elements in another shape, given as to numpy's `reshape`."""
        return self._like(self.stand_in.reshape(*shape))

    def _like(self, view: NDArray[Any]) -> "CudaArray":
        return CudaArray(self.memory, view.ctypes.data, view.shape, self.dtype)

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        """See numba's documentation, "CUDA Array Interface (Version 3)"."""
        return {
            "shape": self.shape,
            "typestr": self.dtype.str,
            "descr": self.dtype.descr,
            "data": (self.address if self.size else 0, False),
            "strides": None,
            "stream": _LEGACY_STREAM,
            "version": 3,
        }

    def __dlpack_device__(self) -> tuple[int, int]:
        return 2, self.context.ordinal  # kDLCUDA

    def __dlpack__(
        self,
        *,
        # Where the receiver will work: that waits for what is being done here
        stream: int | None = None,
        # The latest version that the receiver reads; all read the first
        max_version: tuple[int, int] | None = None,
        dl_device: tuple[int, int] | None = None,  # Where it wants the array
        copy: bool | None = None,  # Whether it wants a copy
    ) -> Any:  # noqa: ANN401  # a PyCapsule
        """Return a capsule with a `DLManagedTensor`, see `dmlc/dlpack`.

        Raises:
            BufferError: It wants what cannot be had.
        """
        del max_version
        if copy or dl_device not in (None, self.__dlpack_device__()):
            raise BufferError("an array on a graphics processor is shared as it is")
        if stream not in (None, -1, _LEGACY_STREAM):
            CudaEvent(self.context).holds(stream)
        return capsule_of(self, self.__dlpack_device__())


class _Place:
    """Tells numpy of memory."""

    def __init__(self, address: int, shape: Sequence[int], size: int) -> None:
        self.__array_interface__ = {
            "data": (address, False),
            "shape": tuple(shape),
            "typestr": f"|V{size}",
            "version": 3,
        }
