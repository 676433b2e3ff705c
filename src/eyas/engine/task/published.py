"""Rewards of published algorithms as terms: functions of named quantities.

The original's algorithm code computes them from its reward packet. The distance that is to be kept,
d there, is how far ahead the target is when it is first observed, at the reset; the original takes
the first step after it, because what it tells at a reset is old.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import exact

Floats = NDArray[np.float64]

_E2E_DISTANCE = 9.0
"""Distance from the place to keep at which the reward of E2E has fallen by 1 [m]."""

_CRASH = -10.0


def e2e(
    target_position_body: Floats,
    first_position_body: Floats,
    relative_yaw: Floats,
    field_of_view: Floats,
) -> Floats:
    """Return the reward of the original's A3C-LSTM (E2E), -1 to 1.

    1 - (((x - d)^2 + y^2)^(1/2) / 9 + 2 |w| / field of view), where w is the relative yaw [rad].
    """
    away = target_position_body[:, :2] - first_position_body[:, :2] * (1.0, 0.0)
    miss = exact.hypot(away[:, 0], away[:, 1]) / _E2E_DISTANCE
    return np.clip(1.0 - (miss + 2.0 / field_of_view * np.abs(relative_yaw)), -1.0, 1.0)


def d_vat(
    target_position_body: Floats,
    first_position_body: Floats,
    field_of_view: Floats,
    late_crash: NDArray[np.bool_],
) -> Floats:
    """Return the reward of the original's D-VAT, 0 to 1, or -10 after a crash.

    (r_x r_y)^(1/3), with r_x = max(0, 1 - |x - d|) and r_y = max(0, 1 - |2 atan(y / x) / field of
    view|). The cube root stays from the third factor, which is 1 there: see `d_vat_3d`. The
    original's costs of speed and effort have the factors 0 and 0.4, but its effort is always 0.
    """
    kept = _kept(target_position_body, first_position_body)
    return _joined(kept * _level(target_position_body, field_of_view), late_crash)


def d_vat_3d(  # one argument for each quantity
    target_position_body: Floats,
    target_position_camera: Floats,
    first_position_body: Floats,
    field_of_view: Floats,
    vertical_field_of_view: Floats,
    late_crash: NDArray[np.bool_],
) -> Floats:
    """Return the same with its vertical factor, for trackers that move up and down.

    r_z = max(0, 1 - |2 e / vertical field of view|), where e is the angle of the target above the
    optical axis. D-VAT (Dionigi et al., 2023) takes the angle above the horizon, since its camera
    looks straight ahead; with a camera that looks down, that would be 0 everywhere.
    """
    ahead, _, above = target_position_camera.T
    angle = exact.atan2(above, ahead)
    upright = np.maximum(0.0, 1.0 - np.abs(2.0 * angle / vertical_field_of_view))
    kept = _kept(target_position_body, first_position_body)
    return _joined(kept * _level(target_position_body, field_of_view) * upright, late_crash)


def speed(velocity: Floats) -> Floats:
    """Return D-VAT's measure of speed, v / (1 + v), 0 to 1; as a cost, its weight is negative."""
    fast = np.linalg.norm(velocity, axis=1)
    return np.asarray(fast / (1.0 + fast), np.float64)


def effort(acceleration: Floats) -> Floats:
    """Return D-VAT's measure of effort, u / (1 + u), 0 to 1, of the acceleration [m/s^2] that the
    body makes; as a cost, its weight is negative.
    """
    hard = np.linalg.norm(acceleration, axis=1)
    return np.asarray(hard / (1.0 + hard), np.float64)


def _kept(target: Floats, first: Floats) -> Floats:
    """Return how well the distance ahead is kept."""
    return np.maximum(0.0, 1.0 - np.abs(target[:, 0] - first[:, 0]))


def _level(target: Floats, field_of_view: Floats) -> Floats:
    """Return how near the target is to straight ahead, sideways."""
    # atan(y / x) is the angle of a line: what is behind counts like what is ahead.
    angle = exact.atan2(np.abs(target[:, 1]), np.abs(target[:, 0]))
    return np.maximum(0.0, 1.0 - 2.0 / field_of_view * angle)


def _joined(product: Floats, crash: NDArray[np.bool_]) -> Floats:
    return np.where(crash, _CRASH, exact.cbrt(np.clip(product, 0.0, 1.0)))


TERMS: Mapping[str, Callable[..., Floats]] = {
    **{"e2e": e2e, "d_vat": d_vat, "d_vat_3d": d_vat_3d, "speed": speed, "effort": effort}
}
"""Terms that `reward.terms` may name without a path."""
