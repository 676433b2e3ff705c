"""The arrays that the kernels share, in named bundles.

T triangles, C chunks, P prototypes (fixtures first, then parts), M meshes (levels of detail,
grouped by prototype), F fixtures, I instances, K workers, J jobs (bands of views). Each chunk and
mesh begins with a triangle whose number is a multiple of 8: eight triangles in a row are a cluster,
which is drawn at once. What fills its last cluster up has no area.

Kernels get bundles of arrays by pointer (`eyas.lanes.operations`) and read them like the bundles
themselves. Numbers of a bundle are float32 if their names are those of light, else float64.
"""

from eyas.engine.render.kernels.bundles.band import Band
from eyas.engine.render.kernels.bundles.geometry import (
    BENT_COLUMNS,
    GROUP,
    LOOK_COLUMNS,
    SHADING_COLUMNS,
    Geometry,
    Movers,
)
from eyas.engine.render.kernels.bundles.lens import (
    DARK,
    ELSEWHERE,
    FACES,
    LENS_TILE,
    Glass,
    LensTables,
)
from eyas.engine.render.kernels.bundles.light import (
    TILE,
    Air,
    Direction,
    Illumination,
    LampFrame,
    Light,
    MapFrame,
    Wind,
)
from eyas.engine.render.kernels.bundles.view import (
    NEAR,
    Plane,
    Planes,
    Point,
    Projection,
    Row,
    View,
)
from eyas.engine.render.kernels.bundles.work import Canvas, Job, Output, Scratch, Task

__all__ = [
    "BENT_COLUMNS",
    "DARK",
    "ELSEWHERE",
    "FACES",
    "GROUP",
    "LENS_TILE",
    "LOOK_COLUMNS",
    "NEAR",
    "SHADING_COLUMNS",
    "TILE",
    "Air",
    "Band",
    "Canvas",
    "Direction",
    "Geometry",
    "Glass",
    "Illumination",
    "Job",
    "LampFrame",
    "LensTables",
    "Light",
    "MapFrame",
    "Movers",
    "Output",
    "Plane",
    "Planes",
    "Point",
    "Projection",
    "Row",
    "Scratch",
    "Task",
    "View",
    "Wind",
]
