"""Where kernels run: what programs ask of a graphics processor, and the same on this processor.

A device has memory of its own. Arrays and bundles are put there once, kernels are launched on them,
and results are read back if the host wants them. `HostDevice` does all of it here, so a program
that is written for devices can be tried, and tested, where there is no graphics processor.
"""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import DTypeLike, NDArray

from eyas.lanes.calls import ParallelCall
from eyas.lanes.held import Held


class DeviceArray(Protocol):
    """A C-contiguous array in the memory of a device; numpy's arrays are those of `HostDevice`."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Its shape."""
        ...

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of its elements."""
        ...

    @property
    def nbytes(self) -> int:
        """Its size [bytes]."""
        ...

    def __getitem__(self, rows: slice) -> Any:  # noqa: ANN401
        """Return some rows, `array[first:last]`, as a `DeviceArray` of the same memory."""
        ...

    def reshape(self, *shape: Any) -> Any:  # noqa: ANN401
        """Return the same memory as a `DeviceArray` of another shape, given as to numpy's."""
        ...


class Device(Protocol):
    """A processor with its memory. Work is done in the order in which it is asked for; calls may
    return before it is done, see `synchronise`.
    """

    name: str

    def empty(self, shape: int | Sequence[int], dtype: DTypeLike) -> Any:  # noqa: ANN401
        """Return a `DeviceArray` of any content."""
        ...

    def zeros(self, shape: int | Sequence[int], dtype: DTypeLike) -> Any:  # noqa: ANN401
        """Return a `DeviceArray` of zeros."""
        ...

    def upload(self, array: NDArray[Any]) -> Any:  # noqa: ANN401
        """Return a copy of an array of numpy as a `DeviceArray`."""
        ...

    def write(self, array: Any, values: NDArray[Any], first: int = 0) -> None:  # noqa: ANN401
        """Write rows of a `DeviceArray`, from row `first` on.

        The values have been read when this returns.
        """
        ...

    def read(self, array: Any) -> NDArray[Any]:  # noqa: ANN401
        """Return a copy of a `DeviceArray` as an array of numpy, after all work before is done."""
        ...

    def clear(self, array: Any) -> None:  # noqa: ANN401
        """Set all bytes of a `DeviceArray` to 0."""
        ...

    def held(self, bundle: Any) -> Any:  # noqa: ANN401
        """Return a bundle laid out for `launch`: a named tuple, also with others in it, of numbers
        and arrays. Those of numpy are uploaded, once each, so what is written into them later may
        not be seen, nor what kernels write; a `DeviceArray` is used as it is.
        """
        ...

    def launch(
        self,
        call: ParallelCall,
        workers: int,
        *bundles: Any,  # noqa: ANN401
        threads: int = 1,
        block: int | None = None,
    ) -> None:
        """Run a kernel for all workers.

        Args:
            call: The kernel. Its workers share nothing but what they write atomically, and run in
                any order.
            workers: How many there are.
            bundles: From `held`.
            threads: Threads of a graphics processor that are one worker: 1, or, if the kernel
                works on lanes, one for each lane, `eyas.lanes.vector.WIDTH`.
            block: Threads that a graphics processor starts together, a multiple of 32; None: 128,
                or `eyas.lanes.vector.BLOCK` if a worker is more than one.
        """
        ...

    def synchronise(self) -> None:
        """Return when all work is done."""
        ...


class HostDevice:
    """This processor as a device.

    Args:
        workers: At most so many workers are told to a kernel, which does all the work with any
            number of them.
        order: Where the order is drawn from in which the workers do their shares, one after
            another; None: threads do them, but those of kernels on lanes the first first: on this
            processor lanes are not written atomically.
    """

    name = "host"

    def __init__(self, workers: int = 1, order: np.random.Generator | None = None) -> None:
        self._workers, self._order = workers, order

    def empty(self, shape: int | Sequence[int], dtype: DTypeLike) -> NDArray[Any]:
        """See `Device`."""
        return np.empty(shape, dtype)

    def zeros(self, shape: int | Sequence[int], dtype: DTypeLike) -> NDArray[Any]:
        """See `Device`."""
        return np.zeros(shape, dtype)

    def upload(self, array: NDArray[Any]) -> NDArray[Any]:
        """See `Device`."""
        return np.array(array, order="C")

    def write(self, array: NDArray[Any], values: NDArray[Any], first: int = 0) -> None:
        """See `Device`."""
        array[first : first + len(values)] = values

    def read(self, array: NDArray[Any]) -> NDArray[Any]:
        """See `Device`."""
        return array.copy()

    def clear(self, array: NDArray[Any]) -> None:
        """See `Device`."""
        array.reshape(-1).view(np.uint8)[:] = 0

    def held(self, bundle: Any) -> Held[Any]:  # noqa: ANN401
        """See `Device`."""
        return Held(bundle)

    def launch(
        self,
        call: ParallelCall,
        workers: int,
        *bundles: Held[Any],
        threads: int = 1,
        block: int | None = None,
    ) -> None:
        """See `Device`."""
        del block
        workers = min(workers, self._workers)
        if self._order is not None:
            call.in_order(self._order.permutation(workers).tolist(), *bundles)
        elif threads > 1:
            call.in_order(list(range(workers)), *bundles)
        else:
            call(workers, *bundles)

    def synchronise(self) -> None:
        """See `Device`."""
