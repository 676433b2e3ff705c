"""What textures are mixed from: noise, masonry, cracks. All repeat at their edges.

Fields have shape (256, 256), pictures (256, 256, 3) with colours 0 to 255 as floats.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.textures.fields import SIZE, Field, fractal
from eyas.lanes import exact

Picture = NDArray[np.float64]
Colour = tuple[float, float, float]


def cracks(
    rng: np.random.Generator,  # Random numbers of the texture
    width: float,  # About half the width of a line [pixels]
    share: float,  # Share of the area that has lines, 0 to 1
) -> Field:
    """Return thin wandering lines, 0 to 1."""
    hills = fractal(rng, 1.7, longest=140.0)
    steep = exact.hypot(hills - np.roll(hills, 1, 0), hills - np.roll(hills, 1, 1)) + 1e-3
    line = np.clip(1.3 - np.abs(hills) / steep / width, 0.0, 1.0)
    where = fractal(rng, 1.8, longest=200.0)
    gate = np.clip((where - np.quantile(where, 1 - share)) * 4.0, 0.0, 1.0)
    return np.asarray(line * gate, np.float64)


@dataclass(frozen=True, slots=True)
class Masonry:
    """A wall or floor of rectangular pieces in rows."""

    shade: Field  # One value for each piece, mean 0, deviation 1
    joint: Field  # 1 in the joints, 0 on the pieces
    across: Field  # Position within the piece from left to right, 0 to 1
    down: Field  # Position within the piece from top to bottom, 0 to 1


def masonry(
    rng: np.random.Generator,  # Random numbers of the texture
    rows: int,  # Rows in the tile; even if `bond` is not 0
    columns: int,  # Pieces in a row
    *,
    joint: float,  # Width of the joints [pixels]
    bond: float = 0.5,  # Shift of every other row, in pieces
) -> Masonry:
    """Return rows of pieces."""
    y = (np.arange(SIZE) + 0.5) * rows / SIZE
    row = np.floor(y).astype(np.int64)
    x = (np.arange(SIZE)[None] + 0.5) * columns / SIZE + bond * (row[:, None] % 2)
    column = np.floor(x).astype(np.int64) % columns
    shades = rng.uniform(-1.73, 1.73, (rows, columns))
    across = x - np.floor(x)
    down = np.broadcast_to((y - row)[:, None], (SIZE, SIZE))
    from_edge = np.minimum(
        np.minimum(across, 1 - across) * SIZE / columns, np.minimum(down, 1 - down) * SIZE / rows
    )
    return Masonry(
        shade=shades[row[:, None], column],
        joint=np.clip(joint / 2 + 0.5 - from_edge, 0.0, 1.0),
        across=across,
        down=down,
    )


def painted(colour: Colour, brightness: Field) -> Picture:
    """Return a colour varied in brightness: 0 leaves it unchanged, 0.1 is a tenth lighter."""
    return np.asarray(np.array(colour) * (1.0 + brightness[..., None]), np.float64)


def mixed(below: Picture, above: Picture | Colour, share: NDArray[np.floating]) -> Picture:
    """Return one picture blended with another by `share`: 1 shows only the upper one."""
    weight = np.clip(share, 0.0, 1.0)[..., None]
    return np.asarray(below * (1 - weight) + np.asarray(above) * weight, np.float64)


def opaque(picture: Picture) -> NDArray[np.uint8]:
    """Return a picture as RGBA bytes without holes."""
    alpha = np.full((SIZE, SIZE, 1), 255.0)
    return np.concatenate([np.clip(np.round(picture), 0, 255), alpha], axis=2).astype(np.uint8)
