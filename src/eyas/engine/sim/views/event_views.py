"""What event cameras see between two looks: pictures at instants that follow the motion."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.event_sensor import EventSensors
from eyas.engine.camera.events import EventsConfig
from eyas.engine.camera.paths import Ways, poses_between, speeds_between
from eyas.engine.camera.poses import Exposure, Moments
from eyas.engine.camera.vibration import Vibration
from eyas.engine.core.clock import PHYSICS_STEP
from eyas.engine.sim.views.exposures import Chosen, Moment, Stage, exposure_of, ways_of
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.snapshot import CameraState, Snapshot

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_LIGHT = 8 << 20  # Bytes of light that are drawn before they are seen


class EventViews:
    """Lets the event sensors of N trackers see.

    As in ESIM (Rebecq et al., CoRL 2018, section 4), the light is computed at least as often as
    anything moves by a pixel.

    Attributes:
        sensors: The sensors.

    Args:
        config: The settings.
        sensors: The sensors.
        steady: The state that pictures show, without vibration.
        vibration: That of the cameras; None: there is none.
        aspect: Height of what the cameras show over its width.
        stage: Who draws what they see.
    """

    def __init__(
        self,
        config: EventsConfig,
        sensors: EventSensors,
        steady: Snapshot,
        vibration: Vibration | None,
        aspect: float,
        stage: Stage,
    ) -> None:
        self.sensors = sensors
        self._config, self._steady, self._vibration = config, steady, vibration
        self._aspect, self._stage = aspect, stage
        count = len(steady.episodes.tick)
        self._before = CameraState.create(count)
        self._origin, self._tick = np.zeros(count, np.int64), np.full(count, -1, np.int64)

    def look(self, chosen: Chosen) -> None:
        """Let the sensors of some trackers see what has changed since their last look, up to the
        instant that pictures show; at the same instant again, their events are the same.
        """
        tick, fresh = self._steady.episodes.tick[chosen], self.sensors.pixels.seen[chosen] == 0
        again = fresh | (tick != self._tick[chosen])
        chosen, tick, fresh = chosen[again], tick[again], fresh[again]
        if not len(chosen):
            return
        self._origin[chosen[fresh]] = tick[fresh]
        self._tick[chosen[fresh]] = tick[fresh]
        exposure = exposure_of(chosen, self._steady, self._vibration)
        for before, now in zip(self._before, exposure.cameras, strict=True):
            before[chosen[fresh]] = now[fresh]
        ways = self._ways(chosen, exposure)
        origin = self._origin[chosen] * PHYSICS_STEP
        self.sensors.forget(chosen.astype(np.int64), ways.begin - origin)
        self._see(chosen, ways, self._samples(chosen, exposure, ways))
        for before, now in zip(self._before, exposure.cameras, strict=True):
            before[chosen] = now
        self._tick[chosen] = tick

    def _ways(self, chosen: Chosen, exposure: Exposure) -> Ways:
        first = CameraState(*(array[chosen] for array in self._before))
        begin = np.multiply(self._tick[chosen], PHYSICS_STEP)
        return Ways(first, exposure.cameras, exposure.shake, begin, exposure.instant)

    def _samples(self, chosen: Chosen, exposure: Exposure, ways: Ways) -> Integers:
        """Return how many pictures each needs: one for each pixel that anything moves."""
        height, width = self.sensors.size
        cameras = exposure.cameras._replace(
            velocity=np.empty((len(chosen), 3)), angular_velocity=np.empty((len(chosen), 3))
        )
        speeds_between(ways, cameras.velocity, cameras.angular_velocity)
        targets, most = self._steady.targets, self._config.most_samples
        way = ways_of(
            exposure._replace(cameras=cameras),
            ways.end - ways.begin,
            (targets.position[:, 2] - targets.rise)[chosen],
            np.array([width, self._aspect, height / width / self._aspect]),
            self._stage.moving(chosen, cameras),
        )
        return np.clip(np.ceil(np.minimum(way, most)), 1, most).astype(np.int64)

    def _see(self, chosen: Chosen, ways: Ways, samples: Integers) -> None:
        """Draw pictures at equal distances of time up to the end of each way, and see them."""
        of = np.repeat(np.arange(len(chosen)), samples)
        number = np.arange(len(of)) - np.repeat(np.cumsum(samples) - samples, samples)
        length = (ways.end - ways.begin)[of]
        later = length * ((number + 1.0) / samples[of] - 1.0)
        time = ways.end[of] + later - self._origin[chosen[of]] * PHYSICS_STEP
        some = max(_LIGHT // (12 * self.sensors.size[0] * self.sensors.size[1]), 1)
        for begin in range(0, len(of), some):
            part = slice(begin, begin + some)
            light = self._light(chosen, ways, of[part], later[part])
            seen, which = np.unique(of[part], return_inverse=True)
            self.sensors.see(chosen[seen].astype(np.int64), which, time[part], light)

    def _light(
        self, chosen: Chosen, ways: Ways, of: Integers, later: Floats
    ) -> NDArray[np.float32]:
        """Return the light at moments, shape (K, 3, H, W)."""
        moments = Moments(of, later, np.empty((len(of), 3)), np.empty((len(of), 3, 3)))
        poses_between(ways, moments)
        fields = ways.last.field_of_view[of]
        cameras = CameraState(moments.position, moments.rotation, fields)
        views, movers = self._stage.views_at(Moment(chosen[of], cameras, later))
        picture = Picture.create(len(of), *self.sensors.size, rgb=False, radiance=True)
        self._stage.render(views, movers, picture, DrawStage.SHADING)
        assert picture.radiance is not None
        return picture.radiance
