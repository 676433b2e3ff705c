"""Pictures as a shutter gives them: with motion blur, and row by row.

An exposure is drawn at several instants, and a picture whose rows are exposed one after the other
in bands. All outputs but colours are those of the middle of the exposure of each band.
"""

from dataclasses import fields, replace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.passes import Pieces, add_passes, pieces_of
from eyas.engine.camera.poses import (
    INSTANTS,
    Exposure,
    Moments,
    Moving,
    ViewMotion,
    motion_in_pixels,
    poses_at,
)
from eyas.engine.camera.shutter import Shutter
from eyas.engine.camera.vibration import Shake, Vibration, no_shake
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.render.outputs import picture_size
from eyas.engine.state.draw import DrawList, DrawStage, Picture, Views
from eyas.engine.state.snapshot import CameraState, Snapshot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Chosen = NDArray[np.int32]

_PLANES = ("rgb", "depth", "object_id", "class_id", "normal")
"""What says the size of a picture without light."""

_MOST_BANDS = 64
_LIGHT = 32 << 20
"""Bytes of light that are drawn before they are added: each call of the renderer takes a while."""


class Moment(NamedTuple):
    """K views of trackers' cameras at moments of their own."""

    trackers: Chosen  # The tracker of each, shape (K,)
    cameras: CameraState  # K cameras
    later: Floats  # How long each is after the instant of its tracker's picture [s], shape (K,)


class PictureStage(Protocol):
    """What is asked of who draws trackers' pictures."""

    def views_at(self, moment: Moment) -> tuple[Views, DrawList]:
        """Return views at moments, and the moving things as these see them."""
        ...

    def moving(self, trackers: Chosen, cameras: CameraState) -> Moving:
        """Return the motion of the actors around trackers."""
        ...

    def render(self, views: Views, movers: DrawList, picture: Picture, until: DrawStage) -> None:
        """Draw views."""
        ...


def exposure_of(
    chosen: Chosen,  # The trackers, shape (V,)
    steady: Snapshot,  # The state that the pictures show, without vibration
    vibration: Vibration | None,  # That of the cameras
) -> Exposure:
    """Return the exposures of some trackers."""
    cameras = CameraState(*(array[chosen] for array in steady.cameras))
    shake = no_shake(len(chosen))
    if vibration is not None:
        shake = Shake(*(array[chosen] for array in vibration.shake))
    instant = np.multiply(steady.episodes.tick[chosen], PHYSICS_STEP)
    return Exposure(cameras, shake, instant)


def ways_of(
    exposure: Exposure,  # V cameras
    window: Floats,  # The time around the instant of each [s], shape (V,)
    floor: Floats,  # Height of the ground that each sees [m], shape (V,)
    frame: Floats,  # See `ViewMotion.frame`
    moving: Moving,  # Things that move
) -> Floats:
    """Return the largest motion through each picture in a given time [pixels], shape (V,)."""
    place, axes = np.zeros((INSTANTS, 3)), np.zeros((INSTANTS, 3, 3))
    seen = ViewMotion(window, floor, frame, moving, place, axes, np.zeros(len(window)))
    motion_in_pixels(exposure, seen)
    return seen.motion


class Exposures:
    """Draws exposures of N trackers' cameras."""

    def __init__(
        self,
        shutter: Shutter,
        steady: Snapshot,  # The state that pictures show, without vibration
        vibration: Vibration | None,  # That of the cameras; None: there is none
        aspect: float,  # Height of what the cameras show over its width
        stage: PictureStage,  # Who draws them
    ) -> None:
        self._shutter, self._steady, self._vibration = shutter, steady, vibration
        self._aspect, self._stage = aspect, stage
        self._light = Picture(None, None, None, None, None)

    def draw(
        self,
        chosen: Chosen,  # The trackers, shape (V,)
        until: DrawStage,  # See `Renderer.draw`
        # V pictures; colours are drawn without blur, radiances are the means of their exposures
        picture: Picture,
    ) -> None:
        """Draw the exposures of some trackers."""
        height, width = picture_size(picture)
        exposure = exposure_of(chosen, self._steady, self._vibration)
        frame = np.array([width, self._aspect, height / width / self._aspect])
        samples, bands = self._pieces(chosen, exposure, frame, height)
        open_for, readout = self._shutter.exposure[chosen], self._shutter.readout[chosen]
        once = np.ones_like(samples)
        if picture.radiance is None or samples.max() == 1:
            middle = pieces_of(once, bands, open_for, readout, height)
            self._draw(chosen, exposure, middle, picture, until)
            return
        others = replace(picture, radiance=None)
        if any(getattr(others, one.name) is not None for one in fields(others)):
            middle = pieces_of(once, bands, open_for, readout, height)
            if not any(getattr(others, name) is not None for name in _PLANES):
                # Boxes alone do not say of what size the picture is.
                others.class_id = np.empty((len(chosen), height, width), np.uint8)
            self._draw(chosen, exposure, middle, others, until)
        passes = pieces_of(samples, bands, open_for, readout, height)
        self._add(chosen, exposure, passes, picture.radiance, until)

    def _pieces(
        self, chosen: Chosen, exposure: Exposure, frame: Floats, height: int
    ) -> tuple[Integers, Integers]:
        """Return the numbers of passes and of bands: neighbours are less than a pixel of motion
        apart, and what moves less than half a pixel has one.
        """
        targets, shutter = self._steady.targets, self._shutter
        floor = (targets.position[:, 2] - targets.rise)[chosen]
        moving = self._stage.moving(chosen, exposure.cameras)
        counts = []
        limits = shutter.config.most_samples, min(_MOST_BANDS, height)
        for window, most in zip((shutter.exposure, shutter.readout), limits, strict=True):
            count = np.ones(len(chosen), np.int64)
            if window[chosen].any():
                ways = ways_of(exposure, window[chosen], floor, frame, moving)
                whole = np.floor(np.minimum(ways, most) + 0.5).astype(np.int64)
                count = np.minimum(1 + whole, most)
            counts.append(count)
        # Of an odd number of bands, the one in the middle sees the instant of the picture.
        return counts[0], np.minimum(counts[1] | 1, height)

    def _draw(
        self, chosen: Chosen, exposure: Exposure, pieces: Pieces, picture: Picture, until: DrawStage
    ) -> None:
        """Draw passes into as many pictures."""
        of = pieces.view[pieces.passed]
        moments = Moments(of, pieces.later, np.empty((len(of), 3)), np.empty((len(of), 3, 3)))
        poses_at(exposure, moments)
        cameras = exposure.cameras
        posed = CameraState(moments.position, moments.rotation, cameras.field_of_view[of])
        views, movers = self._stage.views_at(Moment(chosen[of], posed, pieces.later))
        if len(of) > len(pieces.view):
            views.picture, views.rows = pieces.passed.astype(np.int32), pieces.rows
        self._stage.render(views, movers, picture, until)

    def _add(
        self,
        chosen: Chosen,
        exposure: Exposure,
        passes: Pieces,
        mean: NDArray[np.float32],
        until: DrawStage,
    ) -> None:
        """Write the mean light of passes, some at once."""
        mean[:] = 0.0
        some = max(_LIGHT // mean[0].nbytes, 1)
        for begin in range(0, len(passes.view), some):
            pieces = passes.some(begin, min(begin + some, len(passes.view)))
            drawn = self._room(len(pieces.view), mean.shape[2:])
            self._draw(chosen, exposure, pieces, drawn, until)
            assert drawn.radiance is not None
            add_passes(drawn.radiance, pieces, mean)

    def _room(self, passes: int, size: tuple[int, ...]) -> Picture:
        """Return pictures of light, the same as last time: new memory costs as much as adding."""
        light = self._light.radiance
        if light is None or len(light) < passes or light.shape[2:] != size:
            self._light = Picture.create(passes, *size, rgb=False, radiance=True)
        return self._light.first(passes)
