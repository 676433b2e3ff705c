"""What moving objects would cover of a picture that had no borders, and if nothing hid them."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.lens import NO_LENS, Lens, distorted, principal_point
from eyas.engine.core.optics.pinhole import focal_length
from eyas.engine.render.kernels.bundles import NEAR
from eyas.engine.sim.scenes import load_parts
from eyas.engine.state.draw import DrawList
from eyas.engine.state.motion import ActorState, ActorView
from eyas.engine.state.snapshot import CameraState
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs
from eyas.lanes import PackedBundle, compiled

Floats = NDArray[np.float64]


class _Vertices(NamedTuple):
    """The vertices of the finest meshes of all parts, each once."""

    position: Floats  # In the frame of their part [m], shape (V, 3)
    first: NDArray[np.int64]  # First vertex of each part, and the number of all, shape (K + 1,)


class _Query(NamedTuple):
    """The actors of a world, and a camera."""

    wanted: NDArray[np.int64]  # Actors whose boxes are wanted, shape (B,)
    first_slot: NDArray[np.int64]  # See `Rigs`, shape (A + 1,)
    part: NDArray[np.int32]  # See `DrawList`, shape (1, I)
    pose: NDArray[np.float32]  # See `DrawList`, shape (1, I, 3, 4)
    eye: Floats  # Optical centre [m], shape (3,)
    axes: Floats  # Camera to world; columns forward, left, up, shape (3, 3)
    camera: Floats  # Focal length, and the principal point [pixels], shape (3,)
    bent: int  # 1: `lens` bends the picture
    lens: Lens
    box: Floats  # Left, top, right, bottom of each wanted actor [pixels], shape (B, 4)


class Outlines:
    """Poses the actors around a tracker, and encloses their vertices on the picture plane."""

    def __init__(
        self,
        kind: NDArray[np.int32],  # Kind of each actor, index into `KINDS`, shape (A,)
        width: int,  # Width of the pictures [pixels]
        height: int,  # Their height [pixels]
    ) -> None:
        self._rigs, self._kinds = Rigs(kind), tuple(sorted({*kind.tolist()}))
        self._posed = self._rigs.draw_list(1)
        self._actors: ActorView | None = None  # Whom it shows
        # Buffers of its own: arrays that are always the same need not be laid out for kernels.
        self._state = ActorState.create(1, len(kind))
        self._looks = Looks(np.zeros((1, len(kind)), np.int32), np.ones((1, len(kind), 3), "f4"))
        self._width, self._height = width, height

    def posed(self, actors: ActorView) -> DrawList:
        """Return the parts of all actors, in the slots of `Rigs.first_slot`; the next call
        overwrites them, but for one with the same actors.
        """
        if actors is not self._actors:
            self._actors = actors
            for own, array in zip(self._state, actors.state, strict=True):
                own[:] = array
            self._looks.model[0], self._looks.colour[0] = actors.model, actors.colour
            self._rigs.pose(self._state, self._looks, self._posed)
        return self._posed

    def of(
        self,
        actors: ActorView,  # The actors around the tracker
        wanted: NDArray[np.integer],  # Which of them, shape (B,)
        cameras: CameraState,  # The cameras of all trackers
        tracker: int,  # Whose camera it is
        lens: Lens | None = None,  # Its lens; None: a pinhole
    ) -> Floats:
        """Return the boxes around all vertices of some actors, in their poses at this moment.

        Returns:
            Left, top, right, bottom [pixels], not clipped to the picture. Vertices nearer to the
            camera than its near plane are left out; all 0 if none are left. Shape (B, 4).
        """
        posed = self.posed(actors)
        focal = focal_length(self._width, float(cameras.field_of_view[tracker]))
        query = _Query(
            wanted=np.asarray(wanted, np.int64),
            first_slot=self._rigs.first_slot,
            part=posed.part,
            pose=posed.pose,
            eye=cameras.position[tracker],
            axes=cameras.rotation[tracker],
            camera=np.array([focal, *principal_point(lens or NO_LENS, self._width, self._height)]),
            bent=int(lens is not None),
            lens=lens or NO_LENS,
            box=np.zeros((len(wanted), 4)),
        )
        _enclose(_vertices_of(self._kinds), query)
        return query.box


@compiled
def _enclose(vertices: _Vertices, query: _Query) -> None:
    """Write `_Query.box`."""
    eye, axes = query.eye, query.axes
    focal, middle, centre = query.camera[0], query.camera[1], query.camera[2]
    for row in range(len(query.wanted)):
        actor = query.wanted[row]
        left, top, right, bottom = np.inf, np.inf, -np.inf, -np.inf
        for slot in range(query.first_slot[actor], query.first_slot[actor + 1]):
            part, pose = query.part[0, slot], query.pose[0, slot]
            if part < 0:
                continue
            for k in range(vertices.first[part], vertices.first[part + 1]):
                u, v, w = vertices.position[k, 0], vertices.position[k, 1], vertices.position[k, 2]
                x = pose[0, 0] * u + pose[0, 1] * v + pose[0, 2] * w + pose[0, 3] - eye[0]
                y = pose[1, 0] * u + pose[1, 1] * v + pose[1, 2] * w + pose[1, 3] - eye[1]
                z = pose[2, 0] * u + pose[2, 1] * v + pose[2, 2] * w + pose[2, 3] - eye[2]
                ahead = axes[0, 0] * x + axes[1, 0] * y + axes[2, 0] * z
                if ahead < NEAR:
                    continue
                aside = axes[0, 1] * x + axes[1, 1] * y + axes[2, 1] * z
                above = axes[0, 2] * x + axes[1, 2] * y + axes[2, 2] * z
                if query.bent == 1:
                    over, down = distorted(query.lens, -aside, -above, ahead)
                    column, line = middle + focal * over, centre + focal * down
                else:
                    scale = focal / ahead
                    column, line = middle - scale * aside, centre - scale * above
                left, right = min(left, column), max(right, column)
                top, bottom = min(top, line), max(bottom, line)
        if left <= right:
            query.box[row, 0], query.box[row, 1] = left, top
            query.box[row, 2], query.box[row, 3] = right, bottom


@lru_cache(maxsize=8)
def _vertices_of(kinds: tuple[int, ...]) -> PackedBundle[_Vertices]:
    """Return the vertices of the parts of some kinds, indices into `KINDS`, as in `Rigs`."""
    each = [np.unique(levels[0].positions, axis=0) for levels in load_parts(kinds).parts]
    return PackedBundle(
        _Vertices(
            np.concatenate(each).astype(np.float64),
            np.concatenate([[0], np.cumsum([len(points) for points in each])]).astype(np.int64),
        )
    )
