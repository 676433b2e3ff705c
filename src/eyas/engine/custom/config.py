"""Settings of your own target."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.doors import brought
from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.targets.habit import Behaviour

MESHES = (
    ".dae",
    ".glb",
    ".gltf",
    ".obj",
    ".ply",
    ".stl",
)  # Endings of the mesh files that can be read
ENDINGS = (*MESHES, *brought("eyas.mesh_files"))  # Endings of the files of shapes that can be read

Text = Annotated[str, Field(min_length=1)]
Where = Annotated[float, Field(ge=-1e5, le=1e5)]
Angle = Annotated[float, Field(ge=-7, le=7)]


class CustomConfig(Config):
    """Your own target, in the place of `target`: `mesh`, `path`, `trajectory`, or a `body`
    with a `behaviour`.
    """

    mesh: Text | None = None
    """File of its shape: glTF, GLB, COLLADA, OBJ, STL or PLY (extra `mesh`), a Webots `.proto`, or
    a URDF."""
    path: Annotated[Text | None, NAMES_CODE] = None
    """Class of the target, `package.module:Class`, see `eyas.engine.custom.own.OwnTarget`."""
    trajectory: Text | Annotated[tuple[Text, ...], Field(min_length=1, max_length=64)] | None = None
    """File of the track that moves it, or several: CSV with the columns t, x, y and perhaps z and
    yaw, or t, latitude, longitude; GPX, KML, GeoJSON, TUM, KITTI, logs of PX4 and ArduPilot,
    missions. Longitudes and latitudes need a map that lies there, or `at`."""
    at: tuple[Where, Where, Angle] | None = None
    """Where the first point of the trajectory is put, x and y [m], and the angle by which it is
    turned about it [rad]; None: where the file says."""
    smoothing: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Time over which the positions of `trajectory` are smoothed, see docs/own-targets.md; 0: the
    body passes all points [s]."""
    body: Text = "Pedestrian"
    """Kind that is moved by `trajectory` or `behaviour`, if there is neither `mesh` nor `path`."""
    up: Literal["y", "z"] | None = None
    """Axis that is up in the file; None: y in glTF, in COLLADA what the file says, else z."""
    turn: Angle = 0.0
    """Angle by which the mesh is turned about its height, so that it looks along x [rad]."""
    scale: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    """Factor from the file's unit to metres."""
    most_triangles: Annotated[int, Field(ge=12, le=200_000)] | None = None
    """Number of triangles to which a larger mesh is simplified; None: it is left as it is."""
    behaviour: Behaviour = Behaviour.WANDER
    """Behaviour of a target that has no motion of its own."""
    speed: Annotated[float, Field(ge=0.01, le=50)] = 1.0
    """Speed of a target with a behaviour, or with a trajectory without times [m/s]."""
    words: Text | None = None
    """Description of the target, "a delivery robot"; None: the name of its file or class."""

    @property
    def tracks(self) -> tuple[str, ...]:
        """The files of its trajectories."""
        found = self.trajectory
        return (found,) if isinstance(found, str) else found or ()

    @model_validator(mode="after")
    def _something(self) -> "CustomConfig":
        alone = self.mesh is None and self.path is None and self.trajectory is None
        if alone and "behaviour" not in self.model_fields_set:
            raise ValueError("mesh must be given, or path, trajectory or behaviour")
        if self.mesh is not None and self.path is not None:
            raise ValueError("path must be left out where a mesh is given")
        if self.at is not None and self.trajectory is None:
            raise ValueError("at must be left out where no trajectory is given")
        if self.smoothing > 0.0 and self.trajectory is None:
            raise ValueError("smoothing must be left out where no trajectory is given")
        return self
