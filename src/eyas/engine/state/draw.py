"""Inputs and outputs of the renderer."""

from dataclasses import dataclass, field, fields
from enum import IntEnum
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.pinhole import focal_length
from eyas.engine.state.lighting import LightState
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.scene import ObjectClass


class DrawStage(IntEnum):
    """Stages of drawing a picture, in order; `eyas bench --stages` stops after each."""

    CULLING = 0  # Find the parts of the scene that may be visible
    VERTICES = 1  # Project them to the screen, and leave out the triangles that are not seen
    RASTERISING = 2  # Find the nearest triangle in each pixel, and write all outputs except colours
    MOVERS_LIGHT = 3  # Compute the shadows of moving things and the light of their lamps
    SHADING = 4  # Compute the colours, the last stage


@dataclass(slots=True)
class PartLibrary:
    """The rigid parts that moving things are made of. K parts, each with its levels of detail."""

    parts: tuple[tuple[Mesh, ...], ...]
    """Meshes of each part, the finest first, in the part's own frame."""
    lamps: tuple[bool, ...] = ()
    """Mask of parts: True if a moving thing with this as its largest part has head and tail lamps
    that light the road; empty: none has. In a thing whose first part has lamps, one that has none
    is the body of its trailer."""


NO_SPRAY = np.zeros((0, 0, 8), np.float32)  # `DrawList.spray` where roads are dry.


@dataclass(slots=True)
class DrawList:
    """Moving parts in W worlds, I slots per world."""

    part: NDArray[np.int32]  # Index into the part library, -1 for an empty slot, shape (W, I)
    pose: NDArray[np.float32]  # Part to world: rotation and translation [m], shape (W, I, 3, 4)
    colour: NDArray[np.float32]  # Body colour, sRGB 0 to 1, shape (W, I, 3)
    object_id: NDArray[np.int32]
    """Object id, `ACTOR_OBJECT + actor`, or that of the scene's object a part is drawn on, shape
    (W, I)."""
    object_class: NDArray[np.uint8]
    """`eyas.engine.state.scene.ObjectClass` of each actor, shape (W, A)."""
    lamps: NDArray[np.uint8] = field(default_factory=lambda: np.zeros((0, 0), np.uint8))
    """Lamps that shine now, shape (W, I): bit k those of `Surface.TAIL_LAMP` + k; shape (W, 0) or
    (0, 0) where no thing has any that come and go."""
    spray: NDArray[np.float32] = field(default_factory=lambda: NO_SPRAY)
    """Vehicles that throw up water: place on the road between the rear wheels [m], velocity to east
    and north [m/s], half their width [m], a number of their own and 0, shape (W, ., 8); those that
    stand, or rows of 0, throw up none. Shape (0, 0, 8) where roads are dry."""

    @classmethod
    def create(cls, worlds: int, slots: int, *, lamps: bool = False) -> "DrawList":
        """Return a list of empty slots, for up to `slots` actors of class car.

        Args:
            worlds: Number of worlds.
            slots: Number of slots.
            lamps: Whether things have lamps that come and go.
        """
        return cls(
            part=np.full((worlds, slots), -1, np.int32),
            pose=np.zeros((worlds, slots, 3, 4), np.float32),
            colour=np.ones((worlds, slots, 3), np.float32),
            object_id=np.full((worlds, slots), -1, np.int32),
            object_class=np.full((worlds, slots), ObjectClass.CAR, np.uint8),
            lamps=np.zeros((worlds, slots if lamps else 0), np.uint8),
        )

    def flat(self) -> "DrawList":
        """Return the slots of all worlds as those of one; the arrays are shared."""
        return DrawList(
            part=self.part.reshape(1, -1),
            pose=self.pose.reshape(1, -1, 3, 4),
            colour=self.colour.reshape(1, -1, 3),
            object_id=self.object_id.reshape(1, -1),
            object_class=self.object_class,
            lamps=self.lamps.reshape(1, -1),
        )

    def first(self, worlds: int) -> "DrawList":
        """Return the lists of the first worlds; the arrays are shared."""
        return DrawList(*(getattr(self, array.name)[:worlds] for array in fields(self)))


@dataclass(slots=True)
class Views:
    """V cameras to draw."""

    position: NDArray[np.float64]  # Optical centres, world frame [m], shape (V, 3)
    rotation: NDArray[np.float64]  # Camera to world; columns forward, left, up, shape (V, 3, 3)
    world: NDArray[np.int32]  # World whose moving parts each view shows, shape (V,)
    subject: NDArray[np.int32]
    """Object id of each view's subject, whose box is measured, or -1, shape (V,)."""
    field_of_view: float | NDArray[np.float64]  # Horizontal [rad], of all views, or shape (V,)
    vertical_field_of_view: float | NDArray[np.float64] | None = None
    """[rad], as above; None: pixels are square. Set it to squeeze a wide view into a square
    picture."""
    light: LightState | None = None
    """Changes of the light for each view; None: the weather's own light."""
    instant: NDArray[np.float64] | None = None
    """Time at which what falls and what the wind moves is shown [s], shape (V,); None: nothing
    falls, and the air is calm."""
    falling: bool = True  # Whether flakes, drops and leaves are drawn at that time
    tent: bool | None = None
    """Whether bytes of colours go through a tent filter, see `eyas.engine.render.kernels.tent`;
    None: where a pixel has fewer than four samples."""
    lens: NDArray[np.float64] | None = None
    """Numbers of the lens of each view, see `eyas.engine.core.optics.lens.Lens`, shape (V, 10);
    None: all are pinholes. Fields of view are then those of pinholes with the same focal
    lengths."""
    picture: NDArray[np.int32] | None = None
    """Index of the picture (of P) that each view draws into, those of one picture next to each
    other, shape (V,); None: each into its own."""
    rows: NDArray[np.int32] | None = None
    """First row of its picture that each view draws, and the row after the last, shape (V, 2);
    None: all rows."""

    def filters(self, samples: int) -> bool:
        """Return whether colours of so many samples a pixel go through a tent filter."""
        return samples < 4 if self.tent is None else self.tent

    def fields_of(self, view: int) -> tuple[float, float | None]:
        """Return the horizontal and the vertical field of view of one view [rad]."""
        across, down = self.field_of_view, self.vertical_field_of_view
        return (
            float(across[view]) if isinstance(across, np.ndarray) else across,
            float(down[view]) if isinstance(down, np.ndarray) else down,
        )

    def focal(
        self,
        height: int,  # Height of the pictures [pixels]
        width: int,  # Width of the pictures [pixels]
    ) -> NDArray[np.float64]:
        """Return the focal length along rows and along columns [pixels], shape (V, 2)."""
        focal = np.empty((len(self.position), 2))
        focal[:, 0] = _focal_lengths(width, self.field_of_view)
        focal[:, 1] = focal[:, 0]
        if self.vertical_field_of_view is not None:
            focal[:, 1] = _focal_lengths(height, self.vertical_field_of_view)
        return focal


def _focal_lengths(size: int, fields: float | NDArray[np.float64]) -> float | NDArray[np.float64]:
    """Return the focal length, or that of each view [pixels]."""
    if isinstance(fields, np.ndarray):
        # One by one, since numpy's own tangents differ between processors.
        return np.array([focal_length(size, field) for field in fields.tolist()])
    return focal_length(size, fields)


@dataclass(slots=True)
class Picture:
    """Outputs of V views. Arrays that are None were not requested and cost nothing."""

    rgb: NDArray[np.uint8] | None
    """sRGB, row 0 on top, shape (V, H, W, 3)."""
    depth: NDArray[np.float32] | None
    """Distance along the optical axis [m], infinity for sky, shape (V, H, W)."""
    object_id: NDArray[np.int32] | None
    """Object of each pixel, `SKY_OBJECT` for sky, shape (V, H, W)."""
    subject_box: NDArray[np.int32] | None
    """Box of the pixels that the subject covers, visible or hidden: left, top, right, bottom, the
    last two exclusive; all 0 if it is outside the picture, shape (V, 4)."""
    subject_pixels: NDArray[np.int32] | None
    """Number of the subject's visible pixels, and of its visible and hidden ones, shape (V, 2)."""
    class_id: NDArray[np.uint8] | None = None
    """`eyas.engine.state.scene.ObjectClass` of each pixel's object, shape (V, H, W)."""
    actor_box: NDArray[np.int32] | None = None
    """Boxes like `subject_box` of all actors of each view's world, shape (V, A, 4)."""
    actor_pixels: NDArray[np.int32] | None = None
    """Pixels like `subject_pixels` of the same, shape (V, A, 2)."""
    subject_visible_box: NDArray[np.int32] | None = None
    """Box like `subject_box` of the subject's visible pixels only, shape (V, 4)."""
    actor_visible_box: NDArray[np.int32] | None = None
    """Boxes like `actor_box`, of visible pixels only, shape (V, A, 4)."""
    radiance: NDArray[np.float32] | None = None
    """Linear radiance of red, green and blue, air included, before any exposure, in units of
    `eyas.engine.state.lighting.Lighting`, shape (V, 3, H, W). Where `rgb` is wanted too, it is
    drawn twice."""
    normal: NDArray[np.uint8] | None = None
    """Surface normal of each pixel in the camera's frame: right, down and ahead, each from -1 to 1
    as 0 to 255; all 0 for the sky, shape (V, H, W, 3)."""

    @classmethod
    def create(  # noqa: PLR0913  # every output is requested by name
        cls,
        views: int,
        height: int,
        width: int,
        *,
        rgb: bool = True,
        depth: bool = False,
        object_id: bool = False,
        subject: bool = False,
        class_id: bool = False,
        normal: bool = False,
        radiance: bool = False,
        actors: int = 0,
    ) -> "Picture":
        """Return buffers for the requested outputs; `actors` is the number of actors to measure."""
        plane = (views, height, width)
        return cls(
            rgb=np.zeros((*plane, 3), np.uint8) if rgb else None,
            depth=np.zeros(plane, np.float32) if depth else None,
            object_id=np.zeros(plane, np.int32) if object_id else None,
            subject_box=np.zeros((views, 4), np.int32) if subject else None,
            subject_pixels=np.zeros((views, 2), np.int32) if subject else None,
            class_id=np.zeros(plane, np.uint8) if class_id else None,
            actor_box=np.zeros((views, actors, 4), np.int32) if actors else None,
            actor_pixels=np.zeros((views, actors, 2), np.int32) if actors else None,
            subject_visible_box=np.zeros((views, 4), np.int32) if subject else None,
            actor_visible_box=np.zeros((views, actors, 4), np.int32) if actors else None,
            radiance=np.zeros((views, 3, height, width), np.float32) if radiance else None,
            normal=np.zeros((*plane, 3), np.uint8) if normal else None,
        )

    @property
    def aspect(self) -> float:
        """Height over width."""
        planes = (self.rgb, self.depth, self.object_id, self.class_id, self.normal)
        height, width = next(plane for plane in planes if plane is not None).shape[1:3]
        return float(height / width)

    def first(self, views: int) -> "Picture":
        """Return the first views; the arrays are shared."""
        arrays = (getattr(self, array.name) for array in fields(self))
        return Picture(*(None if array is None else array[:views] for array in arrays))


class MovingParts(NamedTuple):
    """Rigid parts of moving things: the one that each pixel of a picture shows, and where these I
    parts are. A part has the same row in all pictures of an episode.
    """

    row: NDArray[np.int32]
    """Row of each pixel's part, -1 for what stands still, and the sky, shape (H, W)."""
    depth: NDArray[np.float32]
    """Distance along the optical axis [m], infinity for the sky, shape (H, W)."""
    part: NDArray[np.int32]  # Index into the part library, -1 where there is none now, shape (I,)
    pose: NDArray[np.float32]
    """Part to world: rotation, or shear, and translation [m], shape (I, 3, 4)."""


class Renderer(Protocol):
    """A renderer, as simulations need it. Another one may stand in the place of
    `eyas.engine.render`.

    A picture depends on nothing but its view: other views, their order and the number of threads
    do not change a byte.
    """

    def part_reach(self) -> NDArray[np.float64]:
        """Return how far the corners of each part of the library are from its origin [m]."""
        ...

    def influence(self, reach: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance up to which things, their shadows and lamps may show [m].

        Args:
            reach: How far the corners of their parts may be from any point of them [m].
        """
        ...

    def draw(
        self,
        views: Views,
        draw_list: DrawList,
        picture: Picture,
        samples: int = 1,
        until: DrawStage = DrawStage.SHADING,
    ) -> None:
        """Draw views into the arrays of a picture that are not None.

        Args:
            views: V cameras.
            draw_list: The moving things.
            picture: Written in place.
            samples: Colour samples per pixel, 1, 2 or 4. Depth, objects and the subject's
                measurements are always those at the pixels' centres.
            until: Last stage to run, to measure the cost of each stage.

        Raises:
            ConfigError: `samples` is neither 1 nor 4.
            EyasError: The pose of a camera is not finite.
        """
        ...
