"""Places of the surfaces of a vehicle in the textures of its paint and of its panes.

All vehicles share a few textures: each point of a body has its place relative to landmarks
(bumpers, wheel arches, doors, windows), and the texture shows these landmarks at fixed shares of
its width. Seams, handles and frames thus fit bodies of any size, and cost no triangles at any
level of detail.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.state.mesh import Material, Surface

_SIDE = 256  # Texels along a side of a texture
BASE = 0.8  # Brightness of plain paint in the textures, linear: edges are brighter


RAISED = 1.1028  # sRGB value of 1 / `BASE`: a tint that makes up for it


class Region(NamedTuple):
    """A rectangle of a texture [texels], from its lower left corner."""

    left: int
    bottom: int
    right: int
    top: int

    def at(self, across: ArrayLike, up: ArrayLike) -> NDArray[np.float64]:
        """Return texture coordinates [tiles], shape (..., 2), of shares 0 to 1 of its sides."""
        u, v = (np.minimum(np.maximum(share, 0.0), 1.0) for share in (across, up))
        uvs = np.empty((*np.broadcast_shapes(np.shape(u), np.shape(v)), 2))
        uvs[..., 0] = self.left + u * (self.right - self.left)
        uvs[..., 1] = self.bottom + v * (self.top - self.bottom)
        return uvs / _SIDE


SIDE = Region(4, 4, 252, 92)
"""A side from tail to nose, and from the sill to the lower edge of the windows."""
TOP = Region(4, 98, 252, 170)
"""Boot, roof and bonnet from tail to nose, and from the middle to the edge."""
BAND = Region(4, 176, 252, 196)
"""The side windows with their pillars from the first window to the last, and upwards."""
REAR = Region(4, 202, 124, 253)
"""The rear end from the middle to its side, and from below to the height of the belt line."""
FRONT = Region(132, 202, 252, 253)  # The front end, likewise
WINDSCREEN = Region(4, 4, 252, 124)
"""A windscreen from right to left, as seen from outside ahead, and upwards; in the panes."""
REAR_WINDOW = Region(4, 132, 252, 196)  # A rear window; in the panes
SIDE_PANE = Region(4, 204, 252, 252)  # A side window; in the panes
BOX_SIDE = Region(4, 4, 252, 92)
"""A side of a box on wheels from its rear end forward, and upwards; this and those that follow are
in the texture `freight`."""
BOX_ROOF = Region(4, 98, 180, 150)
"""Roof of the box, from the rear end forward, and from the middle to the edge."""
BOX_DOORS = Region(4, 158, 124, 252)  # Doors of the box, from left to right, and upwards
CAB_SIDE = Region(132, 158, 252, 252)  # A side of a truck's cab forward, and upwards
COOLER = Region(188, 98, 252, 150)  # An air conditioner from above
PLAIN = CAB_SIDE.at(np.full(4, 0.1), np.full(4, 0.9))
"""A panel without anything on it, in the texture `freight`."""

SIDE_SHARES = (0.0, 0.126, 0.287, 0.457, 0.66, 0.713, 0.874, 1.0)
"""Tail, both edges of the rear wheel arch, pillar between the doors, front edge of the front door,
both edges of the front arch, nose: as shares of the length."""

TOP_SHARES = (0.0, 0.13, 0.32, 0.55, 0.74, 1.0)
"""Tail, lower and upper edge of the rear window, upper and lower edge of the windscreen, nose."""

BEAMS = (0.03, 0.5, 0.97)
"""Beginning of the side windows, pillar between the doors, end of the side windows."""

STYLES = (
    "saloon",
    "saloon_sunroof",
    "saloon_worn",
    "hatch",
    "hatch_sunroof",
    "hatch_worn",
    "van",
    "van_worn",
    "bus",
)
"""Kinds of bodywork."""

BODYWORK = (*(f"bodywork_{style}" for style in STYLES), "freight")  # Textures of paint


def body_paint(texture: str) -> Material:
    """Return paint with the seams and parts of a texture; its brightness is that of plain paint."""
    return Material(texture=texture, tint=(RAISED, RAISED, RAISED), surface=Surface.PAINT)
