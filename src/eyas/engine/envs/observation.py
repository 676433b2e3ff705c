"""Observations of N agents: their spaces, and the arrays that hold the latest of each."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from eyas.engine.camera.config import CameraConfig, ColourLayout
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.envs.information import sensor_state
from eyas.engine.sensors.stack import FrameStack
from eyas.engine.sensors.table import Fitted, fitted_sensors
from eyas.engine.settings.env import ObservationConfig, ObservationPart
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.grammar.attributes import ATTRIBUTES
from eyas.engine.targets.grammar.naming import Phrase, phrase_about
from eyas.engine.targets.grammar.wording import CHARACTERS, LONGEST
from eyas.engine.task.packet_rows import SENSOR_COUNT
from eyas.engine.task.privileged import PRIVILEGED, fill_privileged

Array = NDArray[Any]
Observation = Array | dict[str, Any]
"""An array; of several parts a dictionary of arrays, with a text, or a tuple of texts, as words."""

_Parts = ObservationPart


def observation_space(config: ObservationConfig, sim: SimConfig) -> gymnasium.Space[Any]:
    """Return the space of one agent's observations.

    Raises:
        ConfigError: The agent is to observe a sensor that it does not have, or words alone.
    """
    sensors_in(config, sim)
    lidar, cameras = sim.lidar, len(sim.cameras)
    if _Parts.CAMERAS in config.parts and cameras == 0:
        raise ConfigError(
            "env.observation.parts: 'cameras' needs further cameras: 'cameras' is empty"
        )
    if _Parts.LIDAR in config.parts and not lidar.enabled:
        raise ConfigError(
            "env.observation.parts: 'lidar' needs a lidar: lidar.enabled (Lidar_Enable) is false"
        )
    if _Parts.EVENTS in config.parts and not sim.camera.events.enabled:
        raise ConfigError(
            "env.observation.parts: 'events' needs the sensor: camera.events.enabled is false"
        )
    if set(config.parts) == {_Parts.WORDS}:
        raise ConfigError("env.observation.parts: 'words' alone is not allowed: add another part")
    spaces: dict[str, gymnasium.Space[Any]] = {
        str(part): _space(part, config, sim) for part in dict.fromkeys(config.parts)
    }
    return gymnasium.spaces.Dict(spaces) if len(spaces) > 1 else next(iter(spaces.values()))


def sensors_in(config: ObservationConfig, sim: SimConfig) -> dict[str, Fitted]:
    """Return the single sensors that an agent observes, by name.

    Raises:
        ConfigError: There is no such part or sensor.
    """
    names = [part for part in config.parts if part not in set(_Parts)]
    fitted = {each.sensor.name: each for each in fitted_sensors(sim.sensors)} if names else {}
    for name in names:
        if name not in fitted:
            known = (*map(str, _Parts), *fitted)
            raise UnknownNameError("env.observation.parts", name, known)
    return {name: fitted[name] for name in names}


def _space(
    part: str, config: ObservationConfig, sim: SimConfig
) -> gymnasium.spaces.Box | gymnasium.spaces.Text:
    lidar, size = sim.lidar, (config.height, config.width)
    plane = (1, *size) if config.layout is ColourLayout.CHW else (*size, 1)
    match part:
        case _Parts.IMAGE:
            shape = FrameStack(0, size, config.colours, config.layout, config.frames).shape
            return gymnasium.spaces.Box(0, 255, shape, np.uint8)
        case _Parts.CAMERAS:
            shape = FrameStack(0, size, config.colours, config.layout, config.frames).shape
            return gymnasium.spaces.Box(0, 255, (len(sim.cameras), *shape), np.uint8)
        case _Parts.CLASSES:
            return gymnasium.spaces.Box(0, int(max(ObjectClass)), plane, np.uint8)
        case _Parts.DEPTH:
            return gymnasium.spaces.Box(0.0, np.inf, plane, np.float32)
        case _Parts.SENSORS | _Parts.PRIVILEGED:
            count = SENSOR_COUNT if part is _Parts.SENSORS else PRIVILEGED
            return gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float32)
        case _Parts.LIDAR:
            return gymnasium.spaces.Box(0.0, lidar.max_range, (lidar.points,), np.float32)
        case _Parts.EVENTS:
            shape = _event_shape(config, sim.camera)
            return gymnasium.spaces.Box(0, 255, shape, np.uint8)
        case _Parts.WORDS:
            return gymnasium.spaces.Text(LONGEST, min_length=0, charset=CHARACTERS)
        case _Parts.ATTRIBUTES:
            return gymnasium.spaces.Box(0.0, 1.0, (len(ATTRIBUTES),), np.float32)
    width = sensors_in(config, sim)[part].sensor.width
    return gymnasium.spaces.Box(-np.inf, np.inf, (width,), np.float32)


def _event_shape(config: ObservationConfig, camera: CameraConfig) -> tuple[int, int, int]:
    events = camera.events
    height, width = events.height or camera.height, events.width or camera.width
    if config.layout is ColourLayout.CHW:
        return 2 * events.bins, height, width
    return height, width, 2 * events.bins


def phrase_of_target(simulation: Simulation, tracker: int) -> Phrase:
    """Return a phrase about a tracker's target that fits nothing else in its view, in a wording for
    training: what is said depends on the episode only.
    """
    view = simulation.view.in_view(tracker)
    row = view.row_of(int(simulation.snapshot.targets.actor[tracker]))
    return phrase_about(view, row, simulation.episode_key(tracker).stream("words"))


class Observer:
    """Observes N trackers.

    Attributes:
        space: The space of one observation.
        visible: Share of each target that the latest picture shows, if it is measured, shape (N,).

    Raises:
        ConfigError: As `observation_space`.
    """

    def __init__(
        self,
        config: ObservationConfig,  # What is observed
        simulation: Simulation,  # The N trackers
        *,
        measures: bool = False,  # Whether targets are measured in the pictures, for teachers
    ) -> None:
        sim = simulation.config
        self.space = observation_space(config, sim)
        self._simulation = simulation
        count, size = simulation.count, (config.height, config.width)
        wanted = frozenset(config.parts)
        self._picture = Picture.create(
            count,
            *size,
            rgb=_Parts.IMAGE in wanted,
            depth=_Parts.DEPTH in wanted,
            class_id=_Parts.CLASSES in wanted,
            subject=measures,
        )
        self.visible = np.zeros(count)
        self._draws = bool(wanted & {_Parts.IMAGE, _Parts.DEPTH, _Parts.CLASSES})
        self._stack = FrameStack(count, size, config.colours, config.layout, config.frames)
        self._latest: dict[str, Array] = {}
        self._single = sensors_in(config, sim)
        self._words: list[str] | None = None
        for part in config.parts:
            space = _space(part, config, sim)
            if isinstance(space, gymnasium.spaces.Text):
                self._words = [""] * count
            else:
                self._latest[part] = np.zeros((count, *space.shape), space.dtype)
        self._names_targets = bool(wanted & {_Parts.WORDS, _Parts.ATTRIBUTES})
        self._last_axis = config.layout is ColourLayout.HWC
        if _Parts.IMAGE in wanted:
            self._latest[_Parts.IMAGE] = self._stack.images
        self._further: dict[str, FrameStack] = {}
        if _Parts.CAMERAS in wanted:
            self._further = {
                camera.name: FrameStack(count, size, config.colours, config.layout, config.frames)
                for camera in sim.cameras
            }
            self._through = Picture.create(count, *size)

    def look(
        self,
        chosen: NDArray[np.int32],
        begun: NDArray[np.bool_],
        covered: NDArray[np.bool_] | None = None,
    ) -> None:
        """Observe some trackers.

        Args:
            chosen: The trackers, shape (V,).
            begun: Whether the episode of each has just begun, shape (V,).
            covered: Whose cameras show nothing: black, infinitely far, sky, shape (V,); None:
                nobody's.
        """
        if self._names_targets:
            for tracker in chosen[begun].tolist():
                phrase = phrase_of_target(self._simulation, tracker)
                self._say(tracker, phrase.words, phrase.attributes)
        if self._draws:
            self._draw(chosen, begun, covered)
        for row, (name, stack) in enumerate(self._further.items()):
            self._look_through(name, stack, chosen, begun, covered)
            self._latest[_Parts.CAMERAS][:, row] = stack.images
        if (sensors := self._latest.get(_Parts.SENSORS)) is not None:
            sensor_state(self._simulation, sensors)
        for name, sensor in self._single.items():
            self._latest[name][:] = self._simulation.view.readings(sensor)
        if (ranges := self._latest.get(_Parts.LIDAR)) is not None:
            seen = self._simulation.view
            assert seen.lidar is not None  # its space says so
            seen.lidar.fill(ranges, seen.state.late)
        if (events := self._latest.get(_Parts.EVENTS)) is not None:
            self._count_events(chosen, events)
        if (privileged := self._latest.get(_Parts.PRIVILEGED)) is not None:
            fill_privileged(self._simulation.snapshot, privileged)

    def _look_through(
        self,
        name: str,
        stack: FrameStack,
        chosen: NDArray[np.int32],
        begun: NDArray[np.bool_],
        covered: NDArray[np.bool_] | None,
    ) -> None:
        """Draw what further cameras of some trackers see, see `look`."""
        picture = self._through.first(len(chosen))
        self._simulation.view.further[name].draw(chosen, picture)
        if covered is not None and covered.any():
            _cover(picture, covered)
        assert picture.rgb is not None
        stack.add(picture.rgb, chosen, begun)

    def _draw(
        self, chosen: NDArray[np.int32], begun: NDArray[np.bool_], covered: NDArray[np.bool_] | None
    ) -> None:
        """Draw what the cameras of some trackers see, see `look`."""
        picture = self._picture.first(len(chosen))
        self._simulation.view.draw(chosen, picture)
        if covered is not None and covered.any():
            _cover(picture, covered)
        if picture.rgb is not None:
            self._stack.add(picture.rgb, chosen, begun)
        if (pixels := picture.subject_pixels) is not None:
            self.visible[chosen] = pixels[:, 0] / np.maximum(pixels[:, 1], 1)
        for part, plane in ((_Parts.DEPTH, picture.depth), (_Parts.CLASSES, picture.class_id)):
            if plane is not None:
                latest = self._latest[part]
                latest[chosen] = plane.reshape(len(chosen), *latest.shape[1:])

    def _count_events(self, chosen: NDArray[np.int32], out: Array) -> None:
        """Write how many events the pixels of some trackers' event cameras have had."""
        sensors = self._simulation.view.events(chosen)
        assert sensors is not None  # its space says so
        planes = np.moveaxis(out, -1, 1) if self._last_axis else out
        counts = np.empty((len(chosen), *planes.shape[1:]), np.uint8)
        sensors.count(chosen.astype(np.int64), counts)
        planes[chosen] = counts

    def copy_to(
        self,
        out: Observation,  # Observations, each array with a leading axis
        rows: NDArray[np.integer] | slice,  # Place of each tracker on that axis, shape (N,)
    ) -> None:
        """Copy the latest observation of each tracker."""
        if not isinstance(out, Mapping):
            out[rows] = next(iter(self._latest.values()))
            return
        for part, array in self._latest.items():
            out[part][rows] = array
        if self._words is not None:
            # Gymnasium has the texts of several environments as a tuple.
            words = np.array(out[_Parts.WORDS], object)
            words[rows] = self._words
            out[_Parts.WORDS] = tuple(words.tolist())

    def tell(
        self,
        words: Sequence[str],  # A phrase for each
        attributes: NDArray[np.float32],  # What these say, shape (N, A)
    ) -> None:
        """Tell all trackers something else than the truth from now on, also in later episodes."""
        self._names_targets = False
        for tracker, own in enumerate(words):
            self._say(tracker, own, attributes[tracker])

    def _say(self, tracker: int, words: str, attributes: NDArray[np.float32]) -> None:
        if self._words is not None:
            self._words[tracker] = words
        if (latest := self._latest.get(_Parts.ATTRIBUTES)) is not None:
            latest[tracker] = attributes

    def one(self, tracker: int) -> Observation:
        """Return a copy of the latest observation of a tracker."""
        copies: dict[str, Any] = {
            str(part): array[tracker].copy() for part, array in self._latest.items()
        }
        if self._words is not None:
            copies[_Parts.WORDS.value] = self._words[tracker]
        return copies if len(copies) > 1 else next(iter(copies.values()))


def _cover(picture: Picture, covered: NDArray[np.bool_]) -> None:
    """Make pictures show what a camera sees through a closed lid."""
    if picture.rgb is not None:
        picture.rgb[covered] = 0
    if picture.depth is not None:
        picture.depth[covered] = np.inf
    if picture.class_id is not None:
        picture.class_id[covered] = ObjectClass.SKY
