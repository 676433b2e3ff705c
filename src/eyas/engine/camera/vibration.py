"""Vibration: what a gimbal leaves of the shaking of its body."""

import math
from typing import Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.core.config import Config
from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Variation, bounds, sample, within
from eyas.engine.state.snapshot import CameraState, Snapshot
from eyas.lanes import compiled, exact, kernel
from eyas.lanes.elementary import sin, sin_cos

Floats = NDArray[np.float64]

AXES = 3  # Roll, pitch and yaw


class VibrationConfig(Config):
    """The shaking of the camera that its gimbal does not take away; by default there is none.

    Gimbals of small drones are specified to +-0.005 to +-0.02 degrees (0.0001 to 0.0003 rad) of
    angular vibration; one whose dampers are hard, or that has none, has ten times as much.
    """

    angle: Annotated[Variation, AfterValidator(within(0.0, 0.1))] = 0.0
    """Root mean square of the shaking about each of the camera's three axes [rad]; sampled for
    each tracker at each reset."""
    lowest: Annotated[float, Field(gt=0, le=1000)] = 8.0
    """Lowest frequency [Hz]."""
    highest: Annotated[float, Field(gt=0, le=1000)] = 120.0
    """Highest frequency; rotors of small drones turn at 60 to 200 Hz [Hz]."""
    decline: Annotated[float, Field(ge=0, le=4)] = 1.0
    """Amplitudes fall with this power of the frequency."""

    @model_validator(mode="after")
    def _band_in_order(self) -> Self:
        if self.lowest > self.highest:
            raise ValueError(f"lowest must not be above highest, which is {self.highest:g} Hz")
        return self


class Shake(NamedTuple):
    """Vibration of N cameras: sums of T sinusoids about roll, pitch and yaw."""

    amplitude: Floats  # [rad], shape (N, 3, T)
    pulsation: Floats  # 2 pi times the frequency [rad/s], shape (N, 3, T)
    phase: Floats  # [rad], shape (N, 3, T)


def no_shake(count: int) -> Shake:
    """Return the vibration of N cameras that keep still."""
    return Shake(*(np.zeros((count, AXES, 0)) for _ in Shake._fields))


@kernel(inline=True)
def _angle(shake: Shake, n: int, axis: int, time: float) -> float:
    total = 0.0
    for k in range(shake.phase.shape[2]):
        turned = shake.pulsation[n, axis, k] * time + shake.phase[n, axis, k]
        total += shake.amplitude[n, axis, k] * sin(turned)
    return total


@kernel(inline=True)
def shaken_axes(
    shake: Shake,  # The vibration
    n: int,  # Whose
    time: float,  # [s]
    axes: Floats,  # Camera to world; columns forward, left, up, shape (3, 3); changed in place
) -> None:
    """Turn a camera by the vibration of camera `n` at a time."""
    if shake.phase.shape[2] == 0:
        return
    roll_sine, roll_cosine = sin_cos(_angle(shake, n, 0, time))
    pitch_sine, pitch_cosine = sin_cos(_angle(shake, n, 1, time))
    yaw_sine, yaw_cosine = sin_cos(_angle(shake, n, 2, time))
    for row in range(3):
        forward, left, up = axes[row, 0], axes[row, 1], axes[row, 2]
        forward, left = (
            yaw_cosine * forward + yaw_sine * left,
            yaw_cosine * left - yaw_sine * forward,
        )
        forward, up = (
            pitch_cosine * forward - pitch_sine * up,
            pitch_sine * forward + pitch_cosine * up,
        )
        left, up = roll_cosine * left + roll_sine * up, roll_cosine * up - roll_sine * left
        axes[row, 0], axes[row, 1], axes[row, 2] = forward, left, up


class _Shaken(NamedTuple):
    """Cameras at their instants, and the same with their vibration."""

    steady: CameraState
    tick: NDArray[np.int64]  # Time of the world in physics steps, shape (N,)
    shaken: CameraState


class Vibration:
    """Shakes N cameras, in their pictures and the labels of these; the gimbals know nothing of it.

    A sum of sinusoids with random phases and amplitudes is nearly a normal process with their
    spectrum (Shinozuka and Jan, 1972). It is a function of time, so that it can be had at any
    instant within an exposure.

    Attributes:
        shake: The sinusoids of the episodes.

    Args:
        config: How much.
        count: N.
    """

    def __init__(self, config: VibrationConfig, count: int) -> None:
        self._config = config
        self.shake = Shake(*(np.zeros((count, AXES, _TONES)) for _ in Shake._fields))
        self._shaken: list[_Shaken] = []

    @classmethod
    def of(cls, config: VibrationConfig, count: int) -> "Vibration | None":
        """Return the vibration of some settings; None if they have none."""
        return cls(config, count) if bounds(config.angle)[1] > 0.0 else None

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Sample the vibration of a tracker's episode.

        Frequencies are one in each of equal parts of the band's logarithm; squares of amplitudes
        are exponentially distributed, as those of a normal process.
        """
        config, rng = self._config, key.stream("vibration")
        angle = sample(config.angle, rng)
        where, how_much, phase = rng.random((3, AXES, _TONES))
        share = (np.arange(_TONES) + where) / _TONES
        width = float(exact.log(config.highest / config.lowest))
        frequency = config.lowest * exact.exp(width * share)
        spectrum = exact.power(frequency, -config.decline)
        total = np.sqrt((spectrum * spectrum).sum(axis=1, keepdims=True))
        level = np.sqrt(-2.0 * exact.log(1.0 - how_much))
        self.shake.amplitude[tracker] = angle * spectrum / total * level
        self.shake.pulsation[tracker] = 2.0 * math.pi * frequency
        self.shake.phase[tracker] = 2.0 * math.pi * phase

    def shaken(self, state: Snapshot) -> Snapshot:
        """Return a state whose cameras shake, kept up by `move`; its other arrays are the same."""
        still = state.cameras
        moved = still._replace(position=still.position, rotation=still.rotation.copy())
        self._shaken.append(_Shaken(still, state.episodes.tick, moved))
        return state._replace(cameras=moved)

    def move(self) -> None:
        """Shake the cameras of all such states as at their instants."""
        for one in self._shaken:
            _shake_all(self.shake, one)


_TONES = 12  # Sinusoids about each axis: enough that the motion does not repeat within an episode


@compiled
def _shake_all(shake: Shake, one: _Shaken) -> None:
    rotation = one.shaken.rotation
    for n in range(rotation.shape[0]):
        for row in range(3):
            for column in range(3):
                rotation[n, row, column] = one.steady.rotation[n, row, column]
        shaken_axes(shake, n, one.tick[n] * PHYSICS_STEP, rotation[n])
