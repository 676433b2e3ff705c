"""System identification: the constants of a drone from a log of its flight, and the report.

The specific force of a drone is the thrust of its rotors, which follow what is asked of them by a
low-pass of first order, and the drag of the air:

    f = up * k * (w1^2 + w2^2 + w3^2 + w4^2) - 1/2 rho * d * |v| * v

in its body frame, with the rates w of the rotors and the velocity v through the air. The thrust
constant k and the drag area d, both over the mass, follow from a linear least-squares fit for each
time constant, of which the best is taken. With them goes by how much the accelerometer is late,
which would pass for drag: half a step of 2 ms in Eyas. Such flights cannot tell the mass alone: a
drone of twice the mass with twice the thrust and drag flies the same.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.trackers.airframe import ORIGINAL
from eyas.robotics.fitting.log import FlightLog

Floats = NDArray[np.float64]

_HELD_OUT = 0.25  # Share of the flight, its end, on which the fit is tried

_BLOCKS = 20  # Parts of the rest, each left out once for the intervals

_QUANTILE = 2.093  # Student's t of 19 degrees of freedom at 95 %

_LONGEST_LAG, _STEPS = 0.4, 33  # The longest time constant [s], and how many are tried at first

_NOTHING = "the flight tells neither thrust nor drag: its rotors never turned, or it never moved"

_DOWN = (
    "its rotors would pull down; allowed: a world frame of east, north, up and a body frame of "
    "forward, left, up"
)

_GRAVITY = ORIGINAL.gravity
_DENSITY = ORIGINAL.air_density

_AHEAD = 1.0  # Horizon of predicted velocities; shorter if half of the held-out part is [s]


@dataclass(frozen=True, slots=True)
class FittedConstant:
    """A number with its interval of confidence of 95 %, by a jackknife over parts of the flight."""

    value: float
    low: float
    high: float

    @property
    def is_determined(self) -> bool:
        """Whether the flight tells more than the order of its size."""
        return self.low > 0.0 and self.high - self.low < self.value

    def times(self, factor: float) -> "FittedConstant":
        """Return a multiple of it."""
        return FittedConstant(factor * self.value, factor * self.low, factor * self.high)


@dataclass(frozen=True, slots=True)
class Fit:
    """What a flight tells of its drone."""

    thrust: FittedConstant
    """Thrust of a rotor over its squared rate and over the mass [m, if rates are in rad/s]."""
    drag: FittedConstant  # Drag coefficient times area over the mass [m^2/kg]
    lag: FittedConstant  # Time constant of the rotors [s]
    hover: float  # Rate of the rotors in hover, in the unit of the log
    seconds: float  # Length of the flight [s]
    rate: float  # Rows per second
    error: float
    """Root of the mean squared error of the specific force in what was held out [m/s^2]."""
    spread: float  # Error of always predicting the mean of what was fitted [m/s^2]
    ahead: float  # Horizon of the predicted velocities [s]
    speed_error: float  # Root of the mean squared error of those velocities [m/s]


def fit(log: FlightLog) -> Fit:
    """Return what a flight tells of its drone.

    Raises:
        DataFileError: It tells nothing: the rotors never turned, or it never moved; or its frames
            are others.
    """
    data = _Data(log)
    lags = _LONGEST_LAG * np.linspace(0.0, 1.0, _STEPS) ** 2
    near = _best(lags, data.sums(lags).sum(axis=1))[0]
    at = min(max(int(np.abs(lags - near).argmin()), 1), _STEPS - 2)
    lags = np.linspace(lags[at - 1], lags[at + 1], 2 * _STEPS)
    sums = data.sums(lags)
    best = _best(lags, sums.sum(axis=1))
    if not best[1] > 0.0:
        raise DataFileError(_DOWN)
    without = (np.delete(sums, block, axis=1).sum(axis=1) for block in range(_BLOCKS))
    left_out = np.array([_best(lags, each) for each in without])
    spread = left_out - left_out.mean(axis=0)
    widths = _QUANTILE * np.sqrt((_BLOCKS - 1) / _BLOCKS * (spread * spread).sum(axis=0))
    delay, thrusts, drags, _ = (
        FittedConstant(float(value), float(value - width), float(value + width))
        for value, width in zip(best, widths, strict=True)
    )
    told = data.predicted(best)
    held = slice(data.fitted, None)
    ahead = min(_AHEAD, 0.5 * float(log.time[-1] - log.time[data.fitted]))
    seconds = float(log.time[-1] - log.time[0])
    return Fit(
        thrust=thrusts,
        drag=drags,
        lag=FittedConstant(delay.value, max(0.0, delay.low), delay.high),
        hover=float(np.sqrt(_GRAVITY / (4.0 * thrusts.value))),
        seconds=seconds,
        rate=(len(log.time) - 1) / seconds,
        error=_root_mean_square(told[held] - data.force[held]),
        spread=_root_mean_square(data.force[held] - data.force[: data.fitted].mean(axis=0)),
        ahead=ahead,
        speed_error=_speed_error(log, told, data.fitted, ahead),
    )


class _Data:
    """A log as the fit needs it.

    Attributes:
        force: Specific force, body frame [m/s^2], shape (K, 3).
        fitted: Number of rows that are fitted, the first ones.
    """

    def __init__(self, log: FlightLog) -> None:
        self._log = log
        measured = log.felt
        self.force = _turned_back(log.attitude, _pulls(log)) if measured is None else measured
        through = _turned_back(log.attitude, log.velocity - log.wind)
        size = np.sqrt((through * through).sum(axis=1, keepdims=True))
        drag = -0.5 * _DENSITY * size * through
        # What an accelerometer tells that is late by a second, to first order.
        late = np.cross(self.force, _rates(log))
        self._others = np.stack([drag, late], axis=1)
        self.fitted = int((1.0 - _HELD_OUT) * len(log.time))
        self._edges = np.linspace(0, self.fitted, _BLOCKS + 1).astype(int)[:-1]

    def sums(self, lags: Floats) -> Floats:
        """Return the normal equations of thrust, drag and lateness over the blocks for each lag,
        with their right sides, shape (lags, blocks, 3, 4).
        """
        squares = _squares(self._log, lags)[: self.fitted]
        force, others = self.force[: self.fitted], self._others[: self.fitted]
        beside = np.concatenate([others, force[:, None]], axis=1)
        products = np.einsum("kia,kja->kij", others, beside)
        table = np.empty((len(lags), _BLOCKS, 3, 4))
        table[:, :, 1:, 1:] = np.add.reduceat(products, self._edges)
        for at, column in enumerate(squares.T):
            own = np.concatenate([column[:, None], beside[:, :, 2]], axis=1) * column[:, None]
            table[at, :, 0] = np.add.reduceat(own, self._edges)
        table[:, :, 1:, 0] = table[:, :, 0, 1:3]
        return table

    def predicted(self, solution: Floats) -> Floats:
        """Return the specific force of a lag, a thrust, a drag and a lateness [m/s^2], (K, 3)."""
        lag, thrust, drag, late = solution
        told: Floats = drag * self._others[:, 0] + late * self._others[:, 1]
        told[:, 2] += thrust * _squares(self._log, np.array([lag]))[:, 0]
        return told


def _best(lags: Floats, sums: Floats) -> Floats:
    """Return the lag, thrust, drag and lateness that leave the least squares, shape (4,)."""
    try:
        solved = np.linalg.solve(sums[..., :3], sums[..., 3:])[..., 0]
    except np.linalg.LinAlgError:
        raise DataFileError(_NOTHING) from None
    explained = (solved * sums[..., 3]).sum(axis=-1)
    if not np.isfinite(explained).all():
        raise DataFileError(_NOTHING)
    at, share = int(explained.argmax()), 0.0
    if 0 < at < len(lags) - 1:  # the top of the parabola through three
        before, here, after = explained[at - 1 : at + 2]
        bend = before - 2.0 * here + after
        share = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
    told = np.column_stack([lags, solved])
    beside = told[at + (1 if share > 0.0 else -1)] if share else told[at]
    best: Floats = (1.0 - abs(share)) * told[at] + abs(share) * beside
    return best


def _squares(log: FlightLog, lags: Floats) -> Floats:
    """Return the sum of the squared rates of the rotors for each lag, shape (K, L).

    What is asked is taken to change evenly between rows, for which the low-pass is exact.
    """
    lags = np.maximum(lags, 1e-6)[:, None]
    rates = np.repeat(log.rotors[:1], len(lags), axis=0)
    told = np.empty((len(log.time), len(lags)))
    told[0] = (rates * rates).sum(axis=1)
    gaps, changes = np.diff(log.time), np.diff(log.rotors, axis=0)
    left = np.exp(-gaps / lags)
    for row, (gap, change) in enumerate(zip(gaps, changes, strict=True)):
        before, behind = log.rotors[row], lags * (change / gap)
        rates = before + change - behind + left[:, row, None] * (rates - before + behind)
        told[row + 1] = (rates * rates).sum(axis=1)
    return told


def _pulls(log: FlightLog) -> Floats:
    """Return the specific force from differences of the velocity, world frame [m/s^2]."""
    told = np.gradient(log.velocity, log.time, axis=0)
    told[:, 2] += _GRAVITY
    return told


def _rates(log: FlightLog) -> Floats:
    """Return turn rates from differences of the attitude, body frame [rad/s], shape (K, 3)."""
    attitude = log.attitude.copy()
    flips = (attitude[1:] * attitude[:-1]).sum(axis=1) < 0.0
    attitude[1:][np.cumsum(flips) % 2 == 1] *= -1.0
    change = np.gradient(attitude, log.time, axis=0)
    real, axis = attitude[:, :1], attitude[:, 1:]
    turned = np.cross(axis, change[:, 1:])
    rates: Floats = 2.0 * (real * change[:, 1:] - change[:, :1] * axis - turned)
    return rates


def _turned_back(attitude: Floats, vectors: Floats) -> Floats:
    """Return vectors of the world frame in the body frame, shape (K, 3)."""
    return _turned(attitude * (1.0, -1.0, -1.0, -1.0), vectors)


def _turned(attitude: Floats, vectors: Floats) -> Floats:
    """Return vectors of the body frame in the world frame, shape (K, 3)."""
    real, axis = attitude[:, :1], attitude[:, 1:]
    twice = 2.0 * np.cross(axis, vectors)
    turned: Floats = vectors + real * twice + np.cross(axis, twice)
    return turned


def _root_mean_square(errors: Floats) -> float:
    return float(np.sqrt((errors * errors).sum(axis=1).mean()))


def _speed_error(log: FlightLog, force: Floats, first: int, ahead: float) -> float:
    """Return the error of velocities predicted by a specific force, from a row on [m/s]."""
    pull = _turned(log.attitude, force)
    pull[:, 2] -= _GRAVITY
    gaps = np.diff(log.time)[:, None]
    gained = np.concatenate([np.zeros((1, 3)), np.cumsum(0.5 * gaps * (pull[1:] + pull[:-1]), 0)])
    missed = log.velocity - gained
    starts = np.arange(first, len(log.time))
    ends = np.searchsorted(log.time, log.time[starts] + ahead)
    inside = ends < len(log.time)
    return _root_mean_square(missed[ends[inside]] - missed[starts[inside]])


def lines(
    fit: Fit,
    mass: float | None,  # Of the drone, where it is known [kg]
    thrust_constant: float | None,  # Thrust of a rotor over its squared rate, where it is known
) -> Iterator[str]:
    """Yield lines that tell a fit."""
    yield f"flight of {fit.seconds:.1f} s at {fit.rate:.0f} Hz; the last quarter is held out"
    yield _row("thrust / (mass rate^2)", fit.thrust, "m")
    yield _row("drag area / mass", fit.drag, "m^2/kg")
    yield _row("time constant of the rotors", fit.lag, "s")
    yield f"{'rate in hover':28} {fit.hover:.4g}"
    for name, estimate, unit in _absolute(fit, mass, thrust_constant):
        yield _row(name, estimate, unit)
    yield (
        f"held out: force per mass {fit.error:.3g} m/s^2 off of {fit.spread:.3g}, "
        f"velocity after {fit.ahead:.2g} s {fit.speed_error:.3g} m/s off"
    )


def record(fit: Fit, mass: float | None, thrust_constant: float | None) -> dict[str, object]:
    """Return a fit as JSON has it: estimates as value, low, high."""
    told: dict[str, object] = {
        "thrust_over_mass": _told(fit.thrust),
        "drag_area_over_mass": _told(fit.drag),
        "motor_time_constant": _told(fit.lag),
        "hover_rate": fit.hover,
    }
    for name, estimate, _ in _absolute(fit, mass, thrust_constant):
        told[name.replace(" ", "_")] = _told(estimate)
    return told | {
        "seconds": fit.seconds,
        "rows_per_second": fit.rate,
        "held_out_error": fit.error,
        "held_out_spread": fit.spread,
        "held_out_seconds_ahead": fit.ahead,
        "held_out_velocity_error": fit.speed_error,
    }


def _absolute(
    fit: Fit, mass: float | None, thrust_constant: float | None
) -> Iterator[tuple[str, FittedConstant, str]]:
    """Yield what follows where the mass, or what gives it, is known."""
    drag = fit.drag
    if thrust_constant is not None:
        low, high = thrust_constant / fit.thrust.high, thrust_constant / fit.thrust.low
        weighed = FittedConstant(thrust_constant / fit.thrust.value, low, high)
        yield "mass", weighed, "kg"
        mass = weighed.value
    elif mass is not None:
        yield "thrust constant", fit.thrust.times(mass), "N / rate^2"
    if mass is not None:
        yield "drag area", drag.times(mass), "m^2"


def _told(estimate: FittedConstant) -> list[float]:
    return [estimate.value, estimate.low, estimate.high]


def _row(name: str, estimate: FittedConstant, unit: str) -> str:
    doubt = "" if estimate.is_determined else "; this flight hardly tells"
    span = f"{estimate.low:.4g} to {estimate.high:.4g}"
    return f"{name:28} {estimate.value:.4g} {unit} ({span}{doubt})"
