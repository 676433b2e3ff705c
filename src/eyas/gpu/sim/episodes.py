"""Episodes of trackers on a device, drawn on the host by the code of all simulations."""

from functools import partial
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.optics.pinhole import field_along, focal_length
from eyas.engine.sim.assets import Assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.episodes import Episodes, Sampler
from eyas.engine.sim.light import LightChanges
from eyas.engine.sim.starts import starts_in
from eyas.engine.sim.worlds import Worlds, each_alone
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.trackers.tracker import Tracker
from eyas.gpu.sim.flight import START
from eyas.gpu.sim.records import arrays_of

Chosen = NDArray[np.int64]


class HostEpisodes:
    """Draws the episodes of N trackers, each in a world of its own.

    Attributes:
        episodes: What draws them.
        worlds: The worlds, whose looks change in place.
        snapshot: The state before the first reset; later only what is drawn is set.
        memory: What the trackers remember; later only what is drawn is set, see `sampled_of`.

    Args:
        config: The settings.
        assets: Map and traffic.
        tracker: The kind of the trackers.
        count: N.
        size: Height and width of the pictures [pixels].
    """

    def __init__(
        self,
        config: SimConfig,
        assets: Assets,
        tracker: Tracker,
        count: int,
        size: tuple[int, int],
    ) -> None:
        self._size, self._aspect = size, config.camera.height / config.camera.width
        self.worlds = Worlds(config, assets, each_alone(count))
        self.snapshot = Snapshot.create(count)
        wind = config.world.wind
        light = LightChanges(config.light, assets.lighting, self.snapshot.light, wind)
        samplers: list[Sampler] = [] if wind is None else [light.blow]
        self.memory = tracker.memory(count, assets.scene.terrain)
        self._sampled = None if tracker.sample is None else tracker.sampled
        if tracker.sample is not None:
            samplers.insert(0, partial(tracker.sample, self.memory))
        traffic, snapshot = assets.traffic, self.snapshot
        starts = starts_in(assets, snapshot, self.worlds, shared_target=config.same_target)
        self.episodes = Episodes(config, traffic, self.worlds, light, snapshot, samplers, starts)

    def begin(self, trackers: Chosen) -> NDArray[Any]:
        """Draw episodes, and return them as rows of `START`, shape (K,).

        Raises:
            SpawnError: A tracker has no possible target.
        """
        pitch = self.episodes.begin(trackers)
        _, cameras, targets, episodes, light = self.snapshot
        rows = np.zeros(len(trackers), START)
        rows["tracker"], rows["pitch"] = trackers, pitch
        rows["number"], rows["tick"] = episodes.number[trackers], episodes.tick[trackers]
        rows["actor"], rows["model"] = targets.actor[trackers], targets.model[trackers]
        for axis, name in enumerate(("ahead", "left", "up", "heading")):
            rows[name] = episodes.start_offset[trackers, axis]
        rows["field_of_view"] = cameras.field_of_view[trackers]
        fields, which = np.unique(rows["field_of_view"], return_inverse=True)
        focal = np.array([self._focal(field) for field in fields.tolist()]).reshape(-1, 2)
        rows["focal_x"], rows["focal_y"] = focal[which].T
        for name in light._fields:
            rows[name] = getattr(light, name)[trackers]
        return rows

    def sampled_of(self, memory: Any) -> list[Any]:  # noqa: ANN401  # the trackers' record
        """Return those arrays of a memory, here or on a device, in which episodes are drawn."""
        return [] if self._sampled is None else arrays_of(attrgetter(self._sampled)(memory))

    def _focal(self, field: float) -> tuple[float, float]:
        """Return the focal lengths of pictures that show a camera's whole view [pixels]."""
        height, width = self._size
        vertical = field_along(field, self._aspect)
        return focal_length(width, field), focal_length(height, vertical)
