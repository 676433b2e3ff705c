"""Eyas: a simulator and benchmark for drone visual active tracking.

    env = eyas.make("citystreet-day")                  # one drone; make_vec: many together
    eyas.record({"video": {"total_time": 2.0}})        # labelled pictures and videos
    eyas.load("runs/video")                            # read them: episodes, frames, arrays
    eyas.evaluate("follow", map="village")             # figures of a policy
    eyas.list_maps()                                   # _weathers, _targets, _presets, _policies

`make_config` returns settings, `train` teaches a policy. Parts of one's own begin with `Writer`,
`Policy`, `RewardTerm`, `Tracker`, `Weather`, `MapPlan` and `Ride`.

The names of `__all__` are public; they are imported when they are asked for. All modules are
private: they move and change without notice. Importing `eyas` makes its environments known to
Gymnasium.
"""

from typing import TYPE_CHECKING, Any

from eyas.envs.registration import register as _register

if TYPE_CHECKING:
    from eyas.core.clock import PHYSICS_STEP as PHYSICS_STEP
    from eyas.core.config import updated as updated
    from eyas.core.errors import ActionError as ActionError
    from eyas.core.errors import ConfigError as ConfigError
    from eyas.core.errors import DataFileError as DataFileError
    from eyas.core.errors import EyasError as EyasError
    from eyas.core.errors import MissingExtraError as MissingExtraError
    from eyas.core.errors import OutputError as OutputError
    from eyas.core.errors import SpawnError as SpawnError
    from eyas.core.errors import UnknownNameError as UnknownNameError
    from eyas.core.files import write_atomic as write_atomic
    from eyas.core.frames import rotate as rotate
    from eyas.custom.own import Ride as Ride
    from eyas.datasets.format import Format as Format
    from eyas.datasets.recording import RecordedEpisode as RecordedEpisode
    from eyas.datasets.recording import RecordedFrame as RecordedFrame
    from eyas.datasets.recording import Recording as Recording
    from eyas.datasets.recording import load as load
    from eyas.envs.keys import hover_action as hover_action
    from eyas.envs.legacy_observation import LegacyObservation as LegacyObservation
    from eyas.envs.lerobot import make_lerobot_env as make_lerobot_env
    from eyas.envs.observation import Observation as Observation
    from eyas.envs.pettingzoo import EyasParallelEnv as EyasParallelEnv
    from eyas.envs.registration import register_map as register_map
    from eyas.envs.sb3 import EyasVecEnv as EyasVecEnv
    from eyas.envs.tracking_env import TrackingEnv as TrackingEnv
    from eyas.envs.vector_env import EyasVectorEnv as EyasVectorEnv
    from eyas.evaluation.box_trackers import BoxTracker as BoxTracker
    from eyas.evaluation.policies.policy import Decision as Decision
    from eyas.evaluation.policies.policy import Policy as Policy
    from eyas.evaluation.policies.policy import PolicyInput as PolicyInput
    from eyas.evaluation.policies.policy import Start as Start
    from eyas.evaluation.steering import towards as towards
    from eyas.exports.frame import Frame as Frame
    from eyas.exports.label import label_schema as label_schema
    from eyas.exports.label import read_labels as read_labels
    from eyas.exports.writer import Episode as Episode
    from eyas.exports.writer import EpisodeWriter as EpisodeWriter
    from eyas.exports.writer import Files as Files
    from eyas.exports.writer import Gather as Gather
    from eyas.exports.writer import Run as Run
    from eyas.exports.writer import Summary as Summary
    from eyas.exports.writer import Writer as Writer
    from eyas.lanes import kernel as kernel
    from eyas.mesh.shell import Shell as Shell
    from eyas.modes.api import evaluate as evaluate
    from eyas.modes.api import export as export
    from eyas.modes.api import make as make
    from eyas.modes.api import make_config as make_config
    from eyas.modes.api import make_dataset as make_dataset
    from eyas.modes.api import make_vec as make_vec
    from eyas.modes.api import record as record
    from eyas.modes.api import track as track
    from eyas.modes.api import train as train
    from eyas.modes.names import list_formats as list_formats
    from eyas.modes.names import list_maps as list_maps
    from eyas.modes.names import list_policies as list_policies
    from eyas.modes.names import list_presets as list_presets
    from eyas.modes.names import list_targets as list_targets
    from eyas.modes.names import list_weathers as list_weathers
    from eyas.settings.config import EyasConfig as EyasConfig
    from eyas.settings.file import load_settings as load_settings
    from eyas.sim.build import build_simulation as build_simulation
    from eyas.sim.config import SimConfig as SimConfig
    from eyas.sim.flights.path import FlightScene as FlightScene
    from eyas.sim.flights.path import FlightSketch as FlightSketch
    from eyas.sim.simulation import Simulation as Simulation
    from eyas.sim.simulation import StepResult as StepResult
    from eyas.sim.worlds import each_alone as each_alone
    from eyas.sim.worlds import together as together
    from eyas.state.draw import Picture as Picture
    from eyas.state.mesh import Material as Material
    from eyas.state.mesh import Mesh as Mesh
    from eyas.state.roads import RoadEdge as RoadEdge
    from eyas.state.roads import RoadGraph as RoadGraph
    from eyas.state.roads import RoadNetwork as RoadNetwork
    from eyas.state.roads import RoadNode as RoadNode
    from eyas.state.scene import ObjectClass as ObjectClass
    from eyas.state.scene import Scene as Scene
    from eyas.state.snapshot import CameraState as CameraState
    from eyas.state.snapshot import Snapshot as Snapshot
    from eyas.state.snapshot import TrackerState as TrackerState
    from eyas.state.terrain import Terrain as Terrain
    from eyas.targets.grammar.attributes import ATTRIBUTES as ATTRIBUTES
    from eyas.task.packets import BasicPacket as BasicPacket
    from eyas.task.packets import InputPacket as InputPacket
    from eyas.task.packets import RewardPacket as RewardPacket
    from eyas.task.radar_packet import RadarPacket as RadarPacket
    from eyas.task.step_line import StepLine as StepLine
    from eyas.task.terms import RewardTerm as RewardTerm
    from eyas.trackers.config import TrackerConfig as TrackerConfig
    from eyas.trackers.flown import flown_drone as flown_drone
    from eyas.trackers.tracker import Tracker as Tracker
    from eyas.world.land.mounds import Mound as Mound
    from eyas.world.maps import MapRecipe as MapRecipe
    from eyas.world.osm.features import Survey as Survey
    from eyas.world.plan.file import read_plan as read_plan
    from eyas.world.plan.file import write_plan as write_plan
    from eyas.world.plan.plan import Hills as Hills
    from eyas.world.plan.plan import MapPlan as MapPlan
    from eyas.world.weather import CLEAR_DAY as CLEAR_DAY
    from eyas.world.weather import DAY as DAY
    from eyas.world.weather import Season as Season
    from eyas.world.weather import Weather as Weather

__version__: str
"""Version of this Eyas, by the tags of git (`tools/version.py`); "0" in a folder that is not
installed. `build_id` identifies the code exactly."""

build_id: str
"""Identifies code and data of this Eyas, see `eyas.core.build`: results of the same build, settings
and seed are the same to the bit."""

_PLACES = {
    "core.clock": ("PHYSICS_STEP",),
    "core.config": ("updated",),
    "core.errors": (
        *("ActionError", "ConfigError", "DataFileError", "EyasError", "MissingExtraError"),
        *("OutputError", "SpawnError", "UnknownNameError"),
    ),
    "core.files": ("write_atomic",),
    "core.frames": ("rotate",),
    "custom.own": ("Ride",),
    "datasets.format": ("Format",),
    "datasets.recording": ("RecordedEpisode", "RecordedFrame", "Recording", "load"),
    "envs.keys": ("hover_action",),
    "envs.legacy_observation": ("LegacyObservation",),
    "envs.lerobot": ("make_lerobot_env",),
    "envs.observation": ("Observation",),
    "envs.pettingzoo": ("EyasParallelEnv",),
    "envs.registration": ("register_map",),
    "envs.sb3": ("EyasVecEnv",),
    "envs.tracking_env": ("TrackingEnv",),
    "envs.vector_env": ("EyasVectorEnv",),
    "evaluation.box_trackers": ("BoxTracker",),
    "evaluation.policies.policy": ("Decision", "Policy", "PolicyInput", "Start"),
    "evaluation.steering": ("towards",),
    "exports.frame": ("Frame",),
    "exports.label": ("label_schema", "read_labels"),
    "exports.writer": (
        *("Episode", "EpisodeWriter", "Files", "Gather", "Run", "Summary", "Writer"),
    ),
    "lanes": ("kernel",),
    "mesh.shell": ("Shell",),
    "modes.api": (
        *("evaluate", "export", "make", "make_config", "make_dataset", "make_vec"),
        *("record", "track", "train"),
    ),
    "modes.names": (
        *("list_formats", "list_maps", "list_policies", "list_presets", "list_targets"),
        "list_weathers",
    ),
    "settings.config": ("EyasConfig",),
    "settings.file": ("load_settings",),
    "sim.build": ("build_simulation",),
    "sim.config": ("SimConfig",),
    "sim.flights.path": ("FlightScene", "FlightSketch"),
    "sim.simulation": ("Simulation", "StepResult"),
    "sim.worlds": ("each_alone", "together"),
    "state.draw": ("Picture",),
    "state.mesh": ("Material", "Mesh"),
    "state.roads": ("RoadEdge", "RoadGraph", "RoadNetwork", "RoadNode"),
    "state.scene": ("ObjectClass", "Scene"),
    "state.snapshot": ("CameraState", "Snapshot", "TrackerState"),
    "state.terrain": ("Terrain",),
    "targets.grammar.attributes": ("ATTRIBUTES",),
    "task.packets": ("BasicPacket", "InputPacket", "RewardPacket"),
    "task.radar_packet": ("RadarPacket",),
    "task.step_line": ("StepLine",),
    "task.terms": ("RewardTerm",),
    "trackers.config": ("TrackerConfig",),
    "trackers.flown": ("flown_drone",),
    "trackers.tracker": ("Tracker",),
    "world.land.mounds": ("Mound",),
    "world.maps": ("MapRecipe",),
    "world.osm.features": ("Survey",),
    "world.plan.file": ("read_plan", "write_plan"),
    "world.plan.plan": ("Hills", "MapPlan"),
    "world.weather": ("CLEAR_DAY", "DAY", "Season", "Weather"),
}
"""Where the public names are. A test holds them equal to the imports above, which type checkers and
editors read."""

_MODULE_OF = {name: f"eyas.{module}" for module, names in _PLACES.items() for name in names}

__all__ = ["__version__", "build_id", *_MODULE_OF]  # texts

_register()


def __getattr__(name: str) -> Any:  # noqa: ANN401  # a public name
    if name == "build_id":  # reads all files of the package, so only when it is asked for
        from eyas.core.build import this_build

        return this_build().id
    if name == "__version__":
        from importlib.metadata import PackageNotFoundError, version

        try:
            found = version("eyas")
        except PackageNotFoundError:
            found = "0"
        globals()[name] = found
        return found
    if name in _MODULE_OF:
        from importlib import import_module

        value = globals()[name] = getattr(import_module(_MODULE_OF[name]), name)
        return value
    raise AttributeError(f"module 'eyas' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
