"""Tables of the lenses in use, see `eyas.engine.render.kernels.bundles.LensTables`."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import Lens, principal_point
from eyas.engine.render.kernels.bundles import FACES, LENS_TILE, LensTables
from eyas.engine.render.kernels.lens.table import Survey, fill_tables, look_around, survey_faces
from eyas.lanes import exact
from eyas.lanes.vector import WIDTH

Floats = NDArray[np.float64]

DENSITY = 1.0
"""Samples of a face, at least, for each sample of the picture, along a side. At 84 x 84, against
pictures of 64 samples for each pixel, single samples then have 29.3 dB (30.3 without a lens) and
four 32.4 dB (33.0; bilinear resampling 31.6). With a density of 1.25 it is 29.7 and 33.4 dB, for a
tenth of a picture's time."""

MOST_SAMPLES = 2.5
"""If one face would have so many times the samples of the picture, more faces are drawn."""

_ASIDE = 0.375 * math.pi
"""Angle between the optical axis and those of the faces aside: they begin at an eighth of a turn
and end at a quarter."""

_KEPT = 8  # Lenses for which tables are kept, if no more are in use

_MARGIN = 1.5  # Pixels around what is seen of a face


def _turns() -> Floats:
    """Return `LensTables.turn` of all faces: ahead, left, right, up, down."""
    cosine, sine = exact.cos(_ASIDE), exact.sin(_ASIDE)
    turns = np.tile(np.eye(3), (FACES, 1, 1))
    for face, (axis, sign) in enumerate([(1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)], 1):
        turns[face, 0, 0], turns[face, 0, axis] = cosine, sign * sine
        turns[face, axis, 0], turns[face, axis, axis] = -sign * sine, cosine
    return turns


_TURNS = _turns()


class _Shape(NamedTuple):
    """Shape of the tables of a picture size."""

    height: int  # [pixels]
    width: int
    across: int  # Samples along a row of each pixel
    down: int  # Samples along a column of each pixel

    def tables(self, lenses: int, tiles: tuple[int, int]) -> LensTables:
        """Return tables without content."""
        padded = self.width + -self.width % WIDTH
        plane = (lenses, self.height * self.down, padded * self.across)
        return LensTables(
            column=np.zeros(plane, np.float32),
            line=np.zeros(plane, np.float32),
            size=np.ones(plane, np.float32),
            face=np.zeros(plane, np.int32),
            faces=np.zeros(lenses, np.int32),
            dark=np.zeros(lenses, np.int32),
            turn=np.tile(_TURNS, (lenses, 1, 1, 1)),
            focal=np.ones((lenses, FACES, 2)),
            extent=np.ones((lenses, FACES, 2), np.int32),
            row=np.zeros((lenses, FACES, self.height, 2), np.int32),
            tile=np.zeros((lenses, FACES, *tiles, 4), np.int32),
            lens=np.zeros((lenses, len(Lens._fields))),
            camera=np.zeros((lenses, 4)),
        )


NO_TABLES = _Shape(0, 0, 1, 1).tables(0, (0, 0))  # What is handed over where there is no lens


class LensBank:
    """The lenses of pictures of one size; those that are no longer used make room for others.

    Attributes:
        tables: Of all of them.
        size: Largest width and height of their faces [pixels].

    Args:
        height: Height of the pictures [pixels].
        width: Their width [pixels].
        across: Samples along a row of each pixel.
        down: Samples along a column of each pixel.
    """

    def __init__(self, height: int, width: int, across: int, down: int) -> None:
        self._shape = _Shape(height, width, across, down)
        self._slots: dict[bytes, int] = {}
        self.tables = self._shape.tables(1, (1, 1))
        self.size = 0, 0

    def slots(self, lenses: Floats, focal: Floats) -> NDArray[np.int32]:
        """Return the rows of `tables` of some lenses, which are made if they are not known.

        Args:
            lenses: The numbers of `Lens`, shape (V, 10).
            focal: Focal lengths of the views [pixels], shape (V, 2).
        """
        numbers = np.concatenate([lenses, focal], axis=1)
        if (numbers == numbers[:1]).all():
            return np.full(len(numbers), self._slot(numbers[0], set()), np.int32)
        keys = [row.tobytes() for row in numbers]
        used = {*keys}
        return np.array(
            [
                self._slots[key] if key in self._slots else self._slot(row, used)
                for key, row in zip(keys, numbers, strict=True)
            ],
            np.int32,
        )

    def _slot(self, numbers: Floats, used: set[bytes]) -> int:
        """Return the row of one lens, and of its focal lengths; `used` must stay."""
        key = numbers.tobytes()
        if key not in self._slots:
            slot = self._free(used)
            self._make(slot, numbers)
            self._slots[key] = slot
        return self._slots[key]

    def _free(self, used: set[bytes]) -> int:
        """Return a row for another lens."""
        lenses = len(self.tables.faces)
        if len(self._slots) < lenses:
            return int(min({*range(lenses)} - {*self._slots.values()}))
        old = next((key for key in self._slots if key not in used), None)
        if old is not None and lenses >= max(_KEPT, 2 * len(used)):
            slot: int = self._slots.pop(old)
            return slot
        self._enlarge(2 * lenses, self.tables.tile.shape[2:4])
        return lenses

    def _enlarge(self, lenses: int, tiles: tuple[int, ...]) -> None:
        """Make larger tables."""
        larger = self._shape.tables(lenses, (tiles[0], tiles[1]))
        arrays: Iterator[tuple[NDArray[Any], NDArray[Any]]] = zip(larger, self.tables, strict=True)
        for new, old in arrays:
            new[tuple(slice(length) for length in old.shape)] = old
        self.tables = larger

    def _make(self, slot: int, numbers: Floats) -> None:
        """Write the tables of a lens."""
        shape = self._shape
        lens = Lens(int(numbers[0]), *numbers[1:10].tolist())
        rows, columns = shape.height * shape.down, shape.width * shape.across
        camera = np.array([*numbers[10:], *principal_point(lens, shape.width, shape.height)])
        survey = Survey(
            lens, camera, shape.across, shape.down,
            np.empty((rows, columns, 4)), np.empty((rows, columns), np.int32),
            _TURNS[:1], np.empty((1, 3)),
        )  # fmt: skip
        look_around(survey)
        survey_faces(survey)
        focal, extent = self._sized(survey.reach, camera)
        if np.prod(extent[0].astype(np.float64)) > MOST_SAMPLES * shape.width * shape.height:
            survey = survey._replace(turn=_TURNS, reach=np.empty((FACES, 3)))
            survey_faces(survey)
            focal, extent = self._sized(survey.reach, camera)
        faces, tables = len(survey.turn), self.tables
        samples = extent.max(axis=0)[::-1] * (shape.down, shape.across)
        tiles = tuple((samples // LENS_TILE + 1).tolist())
        if tiles[0] > tables.tile.shape[2] or tiles[1] > tables.tile.shape[3]:
            wanted = np.maximum(tiles, tables.tile.shape[2:4]).tolist()
            self._enlarge(len(tables.faces), tuple(wanted))
        tables = self.tables
        tables.lens[slot], tables.camera[slot], tables.faces[slot] = numbers[:10], camera, faces
        tables.focal[slot, :faces], tables.extent[slot, :faces] = focal, extent
        tables.dark[slot] = int((survey.face < 0).any())
        fill_tables(survey, tables, slot)
        width, height = tables.extent.max(axis=(0, 1)).tolist()
        self.size = max(width, self.size[0]), max(height, self.size[1])

    def _sized(self, reach: Floats, camera: Floats) -> tuple[Floats, NDArray[np.int32]]:
        """Return the focal lengths [pixels] and sizes of faces.

        Args:
            reach: See `Survey`.
            camera: See `LensTables`.
        """
        # As many samples for each of the picture's as the least dense place needs, with the
        # picture's ratio of width to height of a pixel.
        dense = DENSITY / (reach[:, 2] * math.sqrt(self._shape.across * self._shape.down))
        stretch = math.sqrt(camera[0] / camera[1])
        focal = np.stack([dense * stretch, dense / stretch], axis=1)
        unused = reach[:, 0] == 0.0
        focal[unused] = 1.0
        half = np.ceil(reach[:, :2] * focal + _MARGIN).astype(np.int32)
        # With the parity of the picture, so that without distortion samples lie on samples.
        odd = np.array([self._shape.width & 1, self._shape.height & 1])
        return focal, np.asarray(2 * half - odd, np.int32)
