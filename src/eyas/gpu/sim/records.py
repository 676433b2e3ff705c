"""Records of arrays on a device."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.lanes.device import Device


def uploaded(device: Device, record: Any) -> Any:  # noqa: ANN401  # a record, an array or a number
    """Return a record, a tuple of arrays, of numbers and of other such tuples, with copies of its
    arrays on a device.
    """
    if isinstance(record, np.ndarray):
        return device.upload(record)
    if not isinstance(record, tuple):
        return record
    parts = [uploaded(device, part) for part in record]
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def downloaded(device: Device, record: Any) -> Any:  # noqa: ANN401  # as above
    """Return such a record with copies here of its arrays on a device."""
    if not isinstance(record, tuple):
        return device.read(record) if hasattr(record, "shape") else record
    parts = [downloaded(device, part) for part in record]
    return type(record)(*parts) if hasattr(record, "_fields") else tuple(parts)


def arrays_of(record: Any) -> list[Any]:  # noqa: ANN401  # as above
    """Return all arrays of a record, here or on a device."""
    if isinstance(record, tuple):
        return [array for part in record for array in arrays_of(part)]
    return [record] if hasattr(record, "shape") else []


class Mirrored:
    """An array on a device that only the host writes: what does not change is not uploaded again.

    Attributes:
        array: The array on the device.

    Args:
        device: The device.
        content: What is in it at first.
    """

    def __init__(self, device: Device, content: NDArray[Any]) -> None:
        self.array = device.upload(content)
        self._device, self._content = device, content.copy()

    def write(self, values: NDArray[Any]) -> None:
        """Write the first rows."""
        known = self._content[: len(values)]
        if not np.array_equal(known, values):
            known[:] = values
            self._device.write(self.array, known)
