"""Records of arrays on a device."""

from typing import Any

import numpy as np

from eyas.lanes.device import Device

__all__ = ["uploaded"]


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
