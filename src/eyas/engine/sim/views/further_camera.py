"""Cameras of trackers beside their own: the other eye of a stereo pair, one that looks aside."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import FurtherCameraConfig, MountConfig
from eyas.engine.camera.vibration import Vibration
from eyas.engine.core.frames import rotate
from eyas.engine.core.optics.lens import Lens
from eyas.engine.core.variation import sample
from eyas.engine.sensors.mount import mount_of
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.views.delay import SeenState
from eyas.engine.sim.views.optics import Optics, Stream
from eyas.engine.sim.views.pictures import PictureDrawer
from eyas.engine.sim.worlds import Worlds
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.snapshot import CameraState, Snapshot
from eyas.lanes import exact, interpreted

Chosen = NDArray[np.int32]
Floats = NDArray[np.float64]

_rotate = interpreted(rotate)  # of scalars, but arrays do as well


class FurtherOptics(Optics):
    """What is modelled of the further cameras of one name of N trackers.

    Attributes:
        config: The settings.
        field_of_view: Horizontal [rad], shape (N,).
    """

    def __init__(
        self,
        config: FurtherCameraConfig,  # The settings
        assets: Assets,  # Scene, light and renderer
        hour: float | None,  # Hour of the day; None: the weather's own
        count: int,  # N
    ) -> None:
        super().__init__(config, assets, hour, count)
        self.config = config
        self.field_of_view = np.ones(count)

    def begin(self, tracker: int, stream: Stream) -> None:
        """Begin an episode, see `Optics`."""
        super().begin(tracker, lambda part: stream(f"{part} of {self.config.name}"))

    def _sample(self, tracker: int, stream: Stream) -> None:
        self.field_of_view[tracker] = sample(self.config.field_of_view, stream("field of view"))
        super()._sample(tracker, stream)


class _Shown(NamedTuple):
    """What pictures show, see `ShownState`; cameras shake with what carries them."""

    shown: Snapshot
    steady: Snapshot
    vibration: Vibration | None = None


class FurtherCamera:
    """Draws pictures of the further cameras of one name.

    Attributes:
        cameras: Where they are, from the last `place` on.
    """

    def __init__(
        self,
        optics: FurtherOptics,
        config: SimConfig,  # The settings of the simulation
        assets: Assets,  # Scene and renderer
        worlds: Worlds,  # The worlds, with their moving objects
        light: LightChanges,  # The light around each tracker
        state: SeenState,  # State of the trackers
        *,
        visible: bool,  # Whether trackers see each other
    ) -> None:
        own = optics.config
        self.config, self._optics, self._state = own, optics, state
        self.cameras = CameraState.create(len(optics.field_of_view))
        self._mount = mount_of(own.mount or MountConfig())
        shown = state.shown._replace(cameras=self.cameras)
        self._drawer = PictureDrawer(
            config.model_copy(update={"camera": own}), assets, worlds, light,
            _Shown(shown, shown), optics, visible=visible,
        )  # fmt: skip

    def draw(
        self,
        trackers: Chosen,  # The trackers, shape (V,)
        picture: Picture,  # V pictures to draw into
    ) -> None:
        """Draw what they see now."""
        self.place()
        self._drawer.draw(trackers, picture, DrawStage.SHADING)

    def lens_of(self, tracker: int) -> Lens | None:
        """Return the lens of a tracker's; None: it is a pinhole."""
        lenses = self._optics.bent
        return None if lenses is None else lenses.of_tracker(tracker)

    def place(self) -> None:
        """Set the poses to what they are now."""
        self._optics.ready()
        shown, place, turn = self._state.shown, self._mount.place, self._mount.turn
        cameras, trackers = self.cameras, shown.trackers
        if self.config.on == "camera":
            axes, origin = shown.cameras.rotation, shown.cameras.position
            velocity, turning = shown.cameras.velocity, shown.cameras.angular_velocity
        else:
            axes, origin = _axes_of(trackers.orientation), trackers.position
            velocity = trackers.velocity
            turning = exact.product(axes, trackers.angular_velocity[..., None])[..., 0]
        offset = exact.product(axes, place)
        cameras.rotation[:] = exact.product(axes, turn)
        cameras.position[:] = origin + offset
        cameras.velocity[:] = velocity + np.cross(turning, offset)
        cameras.angular_velocity[:] = turning
        cameras.field_of_view[:] = self._optics.field_of_view


def _axes_of(orientation: Floats) -> Floats:
    """Return the rotations, body to world, of quaternions (N, 4), shape (N, 3, 3)."""
    quaternion = tuple(orientation.T)
    columns = [np.stack(_rotate(quaternion, *axis), axis=-1) for axis in np.eye(3)]
    return np.stack(columns, axis=-1)
