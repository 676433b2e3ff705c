"""Poses of vehicles as small integers, which compress well, and back; not a digit is lost.

A vehicle moves where it heads. So of each step only the part along the nearer axis, east or north,
is kept as it is, by its changes; of the part along the other axis only what differs from the slope
of the heading times the first. Headings are kept by their second differences. Nearly all of these
are within ±127 and take a byte; the others have a list.

Time is the last axis throughout. All sums are those of integers, and the slopes come out of a
table whose content a test pins, so every machine reads the same poses.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Arrays = dict[str, NDArray[np.generic]]

_TURN = 6_283_185  # A full turn [microradians]

_GRAIN = 500
"""Step of the table of slopes: the finest that the middle of two headings has [microradians]."""

_SLOPE_BITS = 20  # Binary places of a slope


def packed(
    position: NDArray[np.int64],  # East and north [cm], shape (A, 2, S), S > 1
    yaw: NDArray[np.int64],  # Heading without jumps at ±180° [mrad], shape (A, S)
) -> Arrays:
    """Return the arrays from which `unpacked` makes these poses again."""
    northward, sign, slope = _directions(yaw)
    step = np.diff(position, axis=-1)
    east, north = step[:, 0], step[:, 1]
    main, other = np.where(northward, north, east), np.where(northward, east, north)
    return {
        "origin": position[..., 0].astype(np.int32),
        **_split("ahead", np.diff(sign * main, axis=-1, prepend=0)),
        **_split("aside", other - _along_slope(main, slope)),
        "yaw_start": yaw[..., :2].astype(np.int32),
        **_split("yaw_second", np.diff(yaw, n=2, axis=-1)),
    }


def unpacked(arrays: Arrays) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return positions (A, 2, S) [cm] and headings (A, S) [mrad] from the arrays of `packed`.

    Raises:
        ValueError, LookupError, TypeError: The arrays don't fit together.
    """
    yaw = _twice_summed(_integers("yaw_start", arrays), _joined("yaw_second", arrays))
    northward, sign, slope = _directions(yaw)
    main = sign * _joined("ahead", arrays).cumsum(axis=-1)
    other = _joined("aside", arrays) + _along_slope(main, slope)
    east, north = np.where(northward, other, main), np.where(northward, main, other)
    start = _integers("origin", arrays)[..., None]
    steps = np.stack([east, north], axis=1)
    return np.concatenate([start, steps], axis=-1).cumsum(axis=-1), yaw


def unpacked_differences(name: str, arrays: Arrays) -> NDArray[np.int64]:
    """Return values that files of format 2 keep by their second differences, shape (..., S).

    Raises:
        ValueError, LookupError, TypeError: The arrays don't fit together.
    """
    second = _integers(f"{name}_second", arrays)
    second.flat[_integers(f"{name}_far", arrays)] = arrays[f"{name}_far_second"]
    return _twice_summed(_integers(f"{name}_start", arrays), second)


def _directions(
    yaw: NDArray[np.int64],
) -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]:
    """Return for each step between headings (A, S) [mrad] whether the middle one is nearer to north
    or south than to east or west, the sign of the step along that axis, and the slope of the other
    axis on it, shape (A, S - 1).
    """
    place = (yaw[:, 1:] + yaw[:, :-1]) * 500 % _TURN // _GRAIN
    northward, sign, slope = _table()
    return northward[place], sign[place], slope[place]


@cache
def _table() -> tuple[NDArray[np.bool_], NDArray[np.int64], NDArray[np.int64]]:
    """Return what `_directions` gives for middle headings up to a full turn, by `_GRAIN`."""
    angle = np.arange(_TURN // _GRAIN + 1) * (_GRAIN * 1e-6)
    east, north = exact.cos(angle), exact.sin(angle)
    northward = abs(north) > abs(east)
    main, other = np.where(northward, north, east), np.where(northward, east, north)
    slope = np.rint(other / main * (1 << _SLOPE_BITS)).astype(np.int64)
    return northward, np.where(main < 0.0, -1, 1), slope


def _along_slope(main: NDArray[np.int64], slope: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the steps along the other axis that go with steps along the main one.

    It is the whole path along the slopes that is rounded, not each step, so that errors stay
    within a centimetre instead of adding up.
    """
    path = (main * slope).cumsum(axis=-1) + (1 << (_SLOPE_BITS - 1)) >> _SLOPE_BITS
    return np.diff(path, axis=-1, prepend=0)


def _split(name: str, values: NDArray[np.int64]) -> Arrays:
    """Return values as bytes, and a list of the places and values of those that are larger."""
    far = np.flatnonzero(np.abs(values) > np.iinfo(np.int8).max)
    near = values.copy()
    near.flat[far] = 0
    return {
        name: near.astype(np.int8),
        f"{name}_far": far.astype(np.int64),
        f"{name}_far_value": values.flat[far].astype(np.int32),
    }


def _joined(name: str, arrays: Arrays) -> NDArray[np.int64]:
    values = _integers(name, arrays)
    values.flat[_integers(f"{name}_far", arrays)] = arrays[f"{name}_far_value"]
    return values


def _integers(name: str, arrays: Arrays) -> NDArray[np.int64]:
    return arrays[name].astype(np.int64, casting="safe")


def _twice_summed(start: NDArray[np.int64], second: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the values of which these are the first two and the second differences."""
    first = np.concatenate([np.diff(start, axis=-1), second], axis=-1).cumsum(axis=-1)
    values: NDArray[np.int64] = np.concatenate([start[..., :1], first], axis=-1).cumsum(axis=-1)
    return values
