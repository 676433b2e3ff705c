"""Pictures of flights, with what the simulator knows of the target in them."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.files import write_atomic
from eyas.engine.state.snapshot import Snapshot
from eyas.lanes import exact

Floats = NDArray[np.float32]


class Shots(NamedTuple):
    """Pictures of E flights at T instants each."""

    picture: NDArray[np.uint8]  # Shape (E, T, 3, H, W)
    place: Floats
    """The target's centre, in the picture or outside of it, column and row [pixels], (E, T, 2)."""
    share: Floats  # Share of the target that is visible, shape (E, T)
    expected: Floats  # Where the tracker expected it, NaN where none flew [pixels], shape (E, T, 2)
    spread: Floats  # Standard deviation of that, or NaN [pixels], shape (E, T)
    flown: NDArray[np.bool_]  # Whether the flight was still under way, shape (E, T)

    @classmethod
    def of(cls, instants: Sequence["Shots"]) -> "Shots":
        """Return those of a batch of flights, of its instants, shape (E, ...) each."""
        return cls(*(np.stack(parts, axis=1) for parts in zip(*instants, strict=True)))

    @classmethod
    def joined(cls, batches: Sequence["Shots"]) -> "Shots":
        """Return those of several batches; shorter flights are filled up with instants unflown."""
        longest = max(batch.flown.shape[1] for batch in batches)

        def padded(part: NDArray[np.generic]) -> NDArray[np.generic]:
            after = [(0, 0)] * part.ndim
            after[1] = 0, longest - part.shape[1]
            return np.pad(part, after)

        parts = zip(*batches, strict=True)
        return cls(*(np.concatenate([padded(each) for each in part]) for part in parts))


def projected(state: Snapshot, size: tuple[int, int]) -> Floats:
    """Return where the targets' centres are in pictures of 4 to 3, shape (N, 2).

    Args:
        size: Height and width [pixels].
    """
    cameras = state.cameras
    away = state.targets.centre - cameras.position
    forward, left, up = np.moveaxis(exact.product(away[:, None], cameras.rotation)[:, 0], -1, 0)
    reach = np.maximum(forward, 0.1) * exact.tan(0.5 * cameras.field_of_view)
    column, row = 1.0 - left / reach, 1.0 - up / (0.75 * reach)
    return np.stack((0.5 * size[1] * column, 0.5 * size[0] * row), axis=-1).astype(np.float32)


def save(shots: Shots, path: Path) -> None:
    """Write pictures to a file of numpy."""
    content = io.BytesIO()
    np.savez(content, **shots._asdict())
    write_atomic(path, content.getvalue())


def load(path: Path) -> Shots:
    """Return the pictures of a file of `save`."""
    with np.load(path) as kept:
        return Shots(**kept)
