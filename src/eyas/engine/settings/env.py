"""Settings of the environments, and the speeds of the actions that they share with recordings."""

from enum import StrEnum
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from eyas.engine.camera.config import ColourLayout, Colours
from eyas.engine.core.config import Config

Speed = Annotated[float, Field(ge=-1e4, le=1e4)]
TurnRate = Annotated[float, Field(ge=-1e3, le=1e3)]


class ActionSpeeds(Config):
    """Speeds of the six actions, each of which moves along or turns about one axis."""

    forward_speed: Speed = 40.0
    """Action 0 [m/s]."""
    backward_speed: Speed = -40.0
    """Action 1 [m/s]."""
    left_speed: Speed = 40.0
    """Action 2 [m/s]."""
    right_speed: Speed = -40.0
    """Action 3 [m/s]."""
    counter_clockwise_rate: TurnRate = 2.0
    """Action 4 [rad/s]; the original's `cw_omega`, whose name states the opposite
    direction."""
    clockwise_rate: TurnRate = -2.0
    """Action 5 [rad/s]; the original's `ccw_omega`."""


class EnvSpeeds(ActionSpeeds):
    """Speeds of the actions. The defaults are those of the original's algorithm code."""

    vertical_speed: Speed = 0.01
    """Speed up and down [m per 2 ms step]; used by actions of four numbers only."""


class GimbalConfig(Config):
    """Range and rates at which an agent turns its camera. The defaults are those of the demo."""

    pitch_rate: Annotated[float, Field(gt=0, le=20)] = 1.5
    """Fastest turn of the camera up and down, by actions with `+gimbal` [rad/s]."""
    yaw_rate: Annotated[float, Field(gt=0, le=20)] = 2.5
    """Fastest turn to the left and right [rad/s]."""
    least_pitch: Annotated[float, Field(ge=-1.6, le=1.6)] = -0.5
    """Highest look, positive down [rad]. The joints of a drone go from -0.5 to 1.5, a car's from
    -1.0."""
    most_pitch: Annotated[float, Field(ge=-1.6, le=1.6)] = 1.5
    """Lowest look, positive down [rad]."""
    most_yaw: Annotated[float, Field(gt=0, le=1.7)] = 1.7
    """Furthest look to each side of the body [rad]."""

    @model_validator(mode="after")
    def _range(self) -> Self:
        if self.least_pitch >= self.most_pitch:
            raise ValueError("least_pitch must be below most_pitch")
        return self


class ActionKind(StrEnum):
    """Kinds of actions of an agent."""

    DISCRETE = "discrete"  # Seven actions: six motions along or about one axis, and hover
    SHARES = "shares"
    """Four numbers from -1 to 1: shares of the speeds forward, left, up and of the turn rate."""
    VELOCITY = "velocity"  # These four in physical units: m/s and, counter-clockwise, rad/s
    DISCRETE_GIMBAL = "discrete+gimbal"
    """Eleven actions: the seven, and four that turn the camera: down, up, left, right."""
    SHARES_GIMBAL = "shares+gimbal"
    """Six numbers from -1 to 1: the four, and shares of the camera's rates down and to the left."""
    VELOCITY_GIMBAL = "velocity+gimbal"
    """Six numbers: the four in physical units, and the camera's rates down and to the left [rad/s].
    """

    @property
    def numbered(self) -> bool:
        """Whether an action is the number of one."""
        return self in (ActionKind.DISCRETE, ActionKind.DISCRETE_GIMBAL)

    @property
    def gimbal(self) -> bool:
        """Whether actions turn the camera."""
        return self.value.endswith("+gimbal")

    @property
    def size(self) -> int:
        """Number of actions, or of the numbers of one."""
        if self.numbered:
            return 11 if self.gimbal else 7
        return 6 if self.gimbal else 4


class ObservationPart(StrEnum):
    """Parts of an observation; of several, it is a dictionary by these names."""

    IMAGE = "image"  # The camera's picture, uint8
    CAMERAS = "cameras"
    """Pictures of the cameras that `cameras` adds, in their order, uint8, along a first axis."""
    DEPTH = "depth"  # Distance along the optical axis [m], float32, infinity for the sky
    CLASSES = "classes"  # `eyas.engine.state.scene.ObjectClass` of each pixel, uint8.
    SENSORS = "sensors"
    """GPS, accelerometer, gyroscope and IMU: 19 numbers of the basic packet, float32."""
    LIDAR = "lidar"
    """Distance of each point of the lidar [m], its longest range where nothing is, float32."""
    EVENTS = "events"
    """Numbers of events of less and of more light each pixel of the event camera has had since the
    last observation, in each part of that time (`camera.events.bins`), at most 255, uint8."""
    WORDS = "words"
    """A sentence that tells the target from all else in the first picture, text; only beside other
    parts."""
    ATTRIBUTES = "attributes"
    """The instruction as numbers, `eyas.engine.targets.grammar.attributes.ATTRIBUTES`, float32."""
    PRIVILEGED = "privileged"
    """State that no sensor measures: the true motion of the target, 16 numbers, float32."""


AnyPart = Annotated[
    ObservationPart | Annotated[str, Field(min_length=1)], Field(union_mode="left_to_right")
]
"""A part, or the name of a sensor in `sensors.further` or of the original's."""


class ObservationConfig(Config):
    """Observations of an agent."""

    parts: Annotated[tuple[AnyPart, ...], Field(min_length=1)] = (ObservationPart.IMAGE,)
    """The parts, and names of single sensors, whose readings they are; of one, the observation is
    its array, of several, a dictionary of arrays."""
    width: Annotated[int, Field(ge=8, le=8192)] = 84
    """Size of picture, depth and classes [pixels]; they show the camera's whole view, squeezed if
    their shape is another."""
    height: Annotated[int, Field(ge=8, le=8192)] = 84
    """Height of the same [pixels]."""
    colours: Colours = Colours.RGB
    """Channels of the picture."""
    layout: ColourLayout = ColourLayout.HWC
    """Order of the axes: channels last, or first as PyTorch wants them."""
    frames: Annotated[int, Field(ge=1, le=64)] = 1
    """Number of the latest pictures in one observation, along the channels, the newest last; after
    a reset all are the first one. Depth and classes are not stacked."""


class MixturePart(Config):
    """A kind of environment among others in one vector environment."""

    weight: Annotated[float, Field(gt=0, le=1e6)] = 1.0
    """Share of the environments, relative to the other parts."""
    settings: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Settings that differ from the common ones, for example `{"world": {"weather": "night"}}`."""


class EnvConfig(Config):
    """Meaning of an agent's actions in the environments, and what it sees."""

    actions: ActionKind = ActionKind.DISCRETE
    """The seven numbered actions; or four numbers for forward, left, up, turn counter-clockwise:
    shares of the speeds from -1 to 1, or m/s and rad/s. With `+gimbal` they also turn the camera
    (docs/training.md)."""
    action_repeat: Annotated[int, Field(ge=1, le=500)] = 1
    """Number of control steps that an action lasts; their rewards are added up, and only the last
    is observed. It ends early with the episode."""
    speeds: EnvSpeeds = EnvSpeeds()
    gimbal: GimbalConfig = GimbalConfig()
    observation: ObservationConfig = ObservationConfig()
    log_folder: Annotated[str, Field(min_length=1)] | None = None
    """If `verbose` is true, folder in which each environment's steps are logged as by the original,
    in `Agent<i>.log`; None: they only go to Python's logger `eyas.steps`."""
    mixture: tuple[MixturePart, ...] = ()
    """Kinds of environments, for example one for each weather; empty: all are alike. Which
    environment is of which kind depends on its index and the weights only."""
