"""A thermal camera: long-wave infrared, 8 to 14 micrometres, by an uncooled microbolometer.

Within that band and the temperatures of a street, radiance grows nearly linearly with temperature,
so pictures show temperatures: what is warm is white.
"""

import math
from typing import Annotated, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from eyas.engine.camera.temperature import (
    CLOTHES,
    ENGINE_HEAT,
    SKIN,
    SurfaceTemperatures,
    direction_of,
)
from eyas.engine.core.config import Config
from eyas.engine.core.counter_rng import mixed
from eyas.engine.core.optics.lens import Lens, undistorted
from eyas.engine.state.draw import DrawList
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.lanes import address_of, kernel, parallel, thread_count
from eyas.lanes.elementary import exp

Celsius = Annotated[float, Field(ge=-100.0, le=500.0)]


class ThermalConfig(Config):
    """The imager of a thermal camera, `camera.spectrum` `thermal`."""

    noise: Annotated[float, Field(ge=0.0, le=10.0)] = 0.05
    """Standard deviation of each pixel in each picture, as a difference of temperature (NETD) [K];
    data sheets of uncooled cameras say 0.04 to 0.06."""
    fixed_pattern: Annotated[float, Field(ge=0.0, le=10.0)] = 0.1
    """Standard deviation of the constant error of each pixel, and of each column, in an episode
    [K]: what is left after the shutter's correction."""
    span: tuple[Celsius, Celsius] | None = None
    """Temperatures shown as black and as white [Celsius]; None: from the coldest to the warmest
    hundredth of each picture."""
    least_span: Annotated[float, Field(gt=0.0, le=200.0)] = 8.0
    """Smallest such difference [K], so that an even scene is not all noise."""

    @model_validator(mode="after")
    def _span_in_order(self) -> Self:
        if self.span is not None and not self.span[0] < self.span[1]:
            raise ValueError(f"span must rise, from the black to the white one; it is {self.span}")
        return self


HEAT = np.dtype(
    [
        *(("kind", np.int32), ("own", np.float32), ("above", np.float32), ("hot", np.float32)),
        *(("x", np.float32), ("y", np.float32), ("z", np.float32), ("reach", np.float32)),
    ],
    align=True,
)
"""How warm a slot of a draw list is. kind: `ObjectClass`; own: share of its temperature that is its
own, not its surface's; above: that one, if own is 0 above its surface's, else [Celsius]; hot: how
much warmer its hottest spot is [K]; x, y, z: that spot, world frame; reach: distance at which a
third of that is left [m]."""


_ENGINE_AT = {
    ObjectClass.CAR: 0.55,
    ObjectClass.TRUCK: 0.6,
    ObjectClass.BUS: -0.75,
    ObjectClass.MOTORCYCLE: 0.1,
    ObjectClass.ROBOT: 0.0,
}
"""Where the hottest spot is, as a share of how far a body reaches from its origin."""


def slot_heat(movers: DrawList, reach: NDArray[np.float64], air: float) -> NDArray[np.void]:
    """Return the heat of moving things, shape (W, I), of `HEAT`.

    The first slot of a vehicle is its body, with the engine under the bonnet, of buses in the rear;
    small later ones are wheels. Small parts of people are their heads and hands.

    Args:
        movers: The moving things, I slots in each of W worlds.
        reach: How far the corners of each part are from its origin, see
            `eyas.engine.state.draw.Renderer.part_reach` [m].
        air: Temperature of the air [Celsius].
    """
    heat = np.zeros(movers.part.shape, HEAT)
    used = movers.part >= 0
    far = np.where(used, reach[np.maximum(movers.part, 0)], 0.0)
    owner = movers.object_id
    first = used & (owner != np.concatenate([np.full((len(owner), 1), -2), owner[:, :-1]], axis=1))
    actor, actors = owner - ACTOR_OBJECT, movers.object_class.shape[1]
    known = used & (actor >= 0) & (actor < actors)
    row = np.take_along_axis(movers.object_class, np.where(known, actor, 0), axis=1)
    kind = np.where(known, row, np.uint8(ObjectClass.ROBOT)).astype(np.int32)
    heat["kind"], heat["reach"] = kind, 1.0
    for one, warm in ENGINE_HEAT.items():
        chosen = used & (kind == one)
        heat["above"][chosen & ~first & (far < 1.5)] = warm.wheels
        _heat_engines(heat, warm.engine, chosen & first, movers.pose, _ENGINE_AT[one] * far)
    people = used & (kind == ObjectClass.PERSON)
    heat["own"][people] = 1.0
    heat["above"][people] = np.where(far < 0.3, SKIN, 0.5 * (CLOTHES + air) + 3.0)[people]
    return heat


def _heat_engines(
    heat: NDArray[np.void],
    engine: float,
    bodies: NDArray[np.bool_],
    pose: NDArray[np.float32],
    ahead: NDArray[np.float64],
) -> None:
    """Set the hottest spots of bodies, so far ahead of their origins [m]."""
    spot = pose[..., 3] + ahead[..., None] * pose[..., :, 0] + np.array([0.0, 0.0, 0.7])
    heat["hot"][bodies] = engine
    for axis, name in enumerate("xyz"):
        heat[name][bodies] = spot[..., axis][bodies]


class ThermalFrames(NamedTuple):
    """What a thermal picture is made of: V views of W worlds."""

    object_id: NDArray[np.int32]
    """Object of each pixel; `ACTOR_OBJECT` + its slot of moving things, shape (V, H, W)."""
    depth: NDArray[np.float32]  # [m], shape (V, H, W)
    normal: NDArray[np.uint8]  # See `Picture.normal`, shape (V, H, W, 3).
    eye: NDArray[np.float64]  # Optical centres [m], shape (V, 3)
    rotation: NDArray[np.float64]  # Camera to world, shape (V, 3, 3)
    ray: NDArray[np.float64]
    """One over the focal length along rows and along columns [1/pixel], shape (V, 2)."""
    lens: NDArray[np.float64]  # The numbers of `Lens`, shape (V, 10), or (0, 10): pinholes
    world: NDArray[np.int32]  # Row of each view in `heat`, shape (V,)
    heat: NDArray[np.void]  # See `slot_heat`, shape (W, I)
    fog: NDArray[np.float32]  # Density of the air [1/m], shape (V,)
    seed: NDArray[np.int64]  # Seed of each view's episode, shape (V,)
    step: NDArray[np.int64]  # Physics steps since its reset, shape (V,)


class ThermalImager:
    """Makes pictures of temperatures."""

    def __init__(
        self,
        config: ThermalConfig,  # The settings
        temperatures: SurfaceTemperatures,  # How warm surfaces are
        object_class: NDArray[np.integer],  # `ObjectClass` of each object of the scene, shape (O,)
    ) -> None:
        low, high = config.span or (0.0, 0.0)
        self._scene = _Scene(
            object_class.astype(np.int32), temperatures.table,
            temperatures.air, temperatures.sky, config.noise / _DEVIATION,
            config.fixed_pattern / _DEVIATION, low, high, config.least_span,
        )  # fmt: skip

    def measure(self, frames: ThermalFrames, rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Write grey pictures, (V, H, W, 3); return the temperature of each pixel [Celsius]."""
        degrees, workers = np.empty(frames.depth.shape, np.float32), min(thread_count(), len(rgb))
        columns = np.empty((workers, rgb.shape[2]))
        _sense(workers, _Work(self._scene, frames, degrees, columns, rgb))
        return degrees


_DEVIATION = 147.8
"""Standard deviation of the sum of four random bytes, see `eyas.engine.sensors.grain`."""

_BINS = 512
_COLDEST, _WARMEST = -70.0, 130.0
"""Temperatures that are told apart where black and white are chosen [Celsius]."""

_CLEARER = 0.5  # Long waves pass fog twice as far as light does

_SKY_AT_HORIZON = 0.12  # Sine of the elevation below which the sky is nearly as warm as the air


class _Scene(NamedTuple):
    """What all pictures of a weather share."""

    object_class: NDArray[np.int32]
    table: NDArray[np.float32]
    air: float
    sky: float
    noise: float
    pattern: float
    low: float
    high: float
    least_span: float


@kernel(inline=True)
def _random(word: int) -> float:
    """Return a nearly normal number of deviation 147.8."""
    word = mixed(word & 0xFFFFFFFF)
    return float((word & 255) + ((word >> 8) & 255) + ((word >> 16) & 255) + (word >> 24) - 510)


@kernel
def _of_mover(
    scene: _Scene, frames: ThermalFrames, view: int, slot: int, facing: tuple[int, int],
    point: tuple[float, float, float],
) -> float:  # fmt: skip
    """Return the temperature of a point of a moving thing."""
    heat = frames.heat[frames.world[view], slot]
    surface = scene.table[heat.kind, facing[0], facing[1]]
    warm = heat.above if heat.own > 0.5 else surface + heat.above
    if heat.hot > 0.0:
        x, y, z = point[0] - heat.x, point[1] - heat.y, point[2] - heat.z
        warm += heat.hot * exp(-(x * x + y * y + z * z) / (heat.reach * heat.reach))
    return float(warm)


@kernel
def _direction(
    frames: ThermalFrames, view: int, row: int, column: int
) -> tuple[float, float, bool]:
    """Return how far left and up the ray of a pixel goes, 1 ahead, and whether light comes in."""
    height, width = frames.depth.shape[1], frames.depth.shape[2]
    if len(frames.lens) == 0:
        left = (0.5 * width - (column + 0.5)) * frames.ray[view, 0]
        return left, (0.5 * height - (row + 0.5)) * frames.ray[view, 1], True
    n = frames.lens[view]
    lens = Lens(int(n[0]), n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9])
    x = (column + 0.5 - (0.5 + lens.right) * width) * frames.ray[view, 0]
    y = (row + 0.5 - (0.5 + lens.below) * height) * frames.ray[view, 1]
    right, down, ahead, area = undistorted(address_of(lens), x, y)
    return -right / ahead, -down / ahead, area > 0.0


@kernel(inline=True)
def _facing(frames: ThermalFrames, view: int, normal: int) -> tuple[int, int]:
    """Return the direction, see `direction_of`, of a normal, its three bytes in one number."""
    axes = frames.rotation[view]
    right, down = (normal & 255) / 127.5 - 1.0, ((normal >> 8) & 255) / 127.5 - 1.0
    ahead = (normal >> 16) / 127.5 - 1.0
    return direction_of(
        ahead * axes[0, 0] - right * axes[0, 1] - down * axes[0, 2],
        ahead * axes[1, 0] - right * axes[1, 1] - down * axes[1, 2],
        ahead * axes[2, 0] - right * axes[2, 1] - down * axes[2, 2],
    )


@kernel(inline=True)
def _temperature(
    scene: _Scene, frames: ThermalFrames, view: int, row: int, column: int, facing: tuple[int, int]
) -> float:
    """Return what a pixel shows [Celsius]; where a lens ends, its mount, as warm as the air."""
    axes = frames.rotation[view]
    left, up, lit = _direction(frames, view, row, column)
    if not lit:
        return scene.air
    x = axes[0, 0] + left * axes[0, 1] + up * axes[0, 2]
    y = axes[1, 0] + left * axes[1, 1] + up * axes[1, 2]
    z = axes[2, 0] + left * axes[2, 1] + up * axes[2, 2]
    stretch = math.sqrt(1.0 + left * left + up * up)
    shown, away = frames.object_id[view, row, column], float(frames.depth[view, row, column])
    if shown < 0:
        clear = min(max(z / stretch / _SKY_AT_HORIZON, 0.0), 1.0)
        return float(scene.air + clear * (scene.sky - scene.air))
    if shown >= ACTOR_OBJECT:
        eye = frames.eye[view]
        point = (eye[0] + away * x, eye[1] + away * y, eye[2] + away * z)
        warm = _of_mover(scene, frames, view, shown - ACTOR_OBJECT, facing, point)
    else:
        warm = float(scene.table[scene.object_class[shown], facing[0], facing[1]])
    through = float(exp(-_CLEARER * frames.fog[view] * away * stretch))
    return scene.air + through * (warm - scene.air)


@kernel
def _limits(degrees: NDArray[np.float32], scene: _Scene) -> tuple[float, float]:
    """Return the temperatures to show as black and as white."""
    if scene.low < scene.high:
        return scene.low, scene.high
    per_bin = (_WARMEST - _COLDEST) / _BINS
    pixels = degrees.shape[0] * degrees.shape[1]
    low, high = _COLDEST, _WARMEST
    # The coldest and the warmest hundredth, found by halving: no memory is needed.
    for upper in range(2):
        least, most = 0, _BINS
        wanted = 0.99 * pixels if upper == 1 else 0.01 * pixels
        while least < most:
            middle = (least + most) // 2
            edge, below = _COLDEST + (middle + 1) * per_bin, 0
            for row in range(degrees.shape[0]):
                for column in range(degrees.shape[1]):
                    below += degrees[row, column] < edge
            if below >= wanted:
                most = middle
            else:
                least = middle + 1
        if upper == 1:
            high = _COLDEST + (least + 1) * per_bin
        else:
            low = _COLDEST + least * per_bin
    middle_of = 0.5 * (low + high)
    half = 0.5 * max(high - low, scene.least_span)
    return middle_of - half, middle_of + half


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    scene: _Scene
    frames: ThermalFrames
    degrees: NDArray[np.float32]
    columns: NDArray[np.float64]  # Errors of the columns of a worker's picture, before scaling
    rgb: NDArray[np.uint8]


@parallel
def _sense(worker: int, workers: int, work: _Work) -> None:
    """Make the pictures whose turn is this worker's."""
    scene, frames, rgb, normals = work.scene, work.frames, work.rgb, work.frames.normal
    columns, height, width = work.columns[worker], rgb.shape[1], rgb.shape[2]
    for view in range(worker, len(rgb), workers):
        own = mixed(frames.seed[view])
        now = mixed(own ^ (frames.step[view] & 0xFFFFFFFF))
        degrees, before, facing = work.degrees[view], -1, (0, 0)
        for column in range(width):
            columns[column] = _random(own ^ (-1 - column))
        for row in range(height):
            for column in range(width):
                at = row * width + column
                normal = int(normals[view, row, column, 0])
                normal |= int(normals[view, row, column, 1]) << 8
                normal |= int(normals[view, row, column, 2]) << 16
                if normal != before:  # most pixels face as their neighbours do
                    before, facing = normal, _facing(frames, view, normal)
                degrees[row, column] = (
                    _temperature(scene, frames, view, row, column, facing)
                    + scene.pattern * (_random(own ^ at) + columns[column])
                    + scene.noise * _random(now ^ at)
                )
        low, high = _limits(degrees, scene)
        scale = 255.0 / (high - low)
        for row in range(height):
            for column in range(width):
                value = (degrees[row, column] - low) * scale + 0.5
                grey = int(min(max(value, 0.0), 255.0))
                for channel in range(3):
                    rgb[view, row, column, channel] = grey
