"""Eyas: a simulator and benchmark for drone visual active tracking.

    env = eyas.make("citystreet-day")                  # one drone; make_vec: many together
    eyas.record({"video": {"total_time": 2.0}})        # labelled pictures and videos
    eyas.load("runs/video")                            # read them: episodes, frames, arrays
    eyas.evaluate("follow", map="village")             # figures of a policy
    eyas.list_maps()                                   # _weathers, _policies, _protocols, ...

`make_config` returns settings, `train` teaches a policy. Parts of one's own begin with `Writer`,
`Policy`, `RewardTerm`, `Sensor`, `Tracker`, `Algorithm`, `Weather`, `MapPlan`, `Face` and `Ride`.

The names of `__all__` are public; they are imported when they are asked for. All modules are
private: they move and change without notice. Importing `eyas` makes its environments known to
Gymnasium.
"""

from typing import TYPE_CHECKING, Any

from eyas.engine.envs.registration import register as _register

if TYPE_CHECKING:
    from eyas.benchmark.api import evaluate as evaluate
    from eyas.benchmark.api import list_policies as list_policies
    from eyas.benchmark.api import list_protocols as list_protocols
    from eyas.benchmark.policies.box_trackers import BoxTracker as BoxTracker
    from eyas.benchmark.protocols.table import protocol_named as protocol_named
    from eyas.dat.observation import LegacyObservation as LegacyObservation
    from eyas.datasets.api import make_dataset as make_dataset
    from eyas.datasets.api import track as track
    from eyas.engine.api import export as export
    from eyas.engine.api import make as make
    from eyas.engine.api import make_config as make_config
    from eyas.engine.api import make_vec as make_vec
    from eyas.engine.api import record as record
    from eyas.engine.core.clock import PHYSICS_STEP as PHYSICS_STEP
    from eyas.engine.core.config import Config as Config
    from eyas.engine.core.config import updated as updated
    from eyas.engine.core.errors import ActionError as ActionError
    from eyas.engine.core.errors import ConfigError as ConfigError
    from eyas.engine.core.errors import DataFileError as DataFileError
    from eyas.engine.core.errors import EyasError as EyasError
    from eyas.engine.core.errors import MissingExtraError as MissingExtraError
    from eyas.engine.core.errors import OutputError as OutputError
    from eyas.engine.core.errors import SpawnError as SpawnError
    from eyas.engine.core.errors import UnknownNameError as UnknownNameError
    from eyas.engine.core.files import write_atomic as write_atomic
    from eyas.engine.core.frames import rotate as rotate
    from eyas.engine.core.frames import rotate_back as rotate_back
    from eyas.engine.custom.own import Ride as Ride
    from eyas.engine.envs.lerobot import make_lerobot_env as make_lerobot_env
    from eyas.engine.envs.observation import Observation as Observation
    from eyas.engine.envs.pettingzoo import EyasParallelEnv as EyasParallelEnv
    from eyas.engine.envs.play import hover_action as hover_action
    from eyas.engine.envs.registration import register_map as register_map
    from eyas.engine.envs.sb3 import EyasVecEnv as EyasVecEnv
    from eyas.engine.envs.tracking_env import TrackingEnv as TrackingEnv
    from eyas.engine.envs.vector_env import EyasVectorEnv as EyasVectorEnv
    from eyas.engine.exports.frame import Frame as Frame
    from eyas.engine.exports.label import label_schema as label_schema
    from eyas.engine.exports.label import read_labels as read_labels
    from eyas.engine.exports.writer import Episode as Episode
    from eyas.engine.exports.writer import EpisodeWriter as EpisodeWriter
    from eyas.engine.exports.writer import Files as Files
    from eyas.engine.exports.writer import Gather as Gather
    from eyas.engine.exports.writer import Run as Run
    from eyas.engine.exports.writer import Summary as Summary
    from eyas.engine.exports.writer import Writer as Writer
    from eyas.engine.mesh.shell import Shell as Shell
    from eyas.engine.names import list_formats as list_formats
    from eyas.engine.names import list_maps as list_maps
    from eyas.engine.names import list_presets as list_presets
    from eyas.engine.names import list_targets as list_targets
    from eyas.engine.names import list_weathers as list_weathers
    from eyas.engine.policies.policy import Decision as Decision
    from eyas.engine.policies.policy import Policy as Policy
    from eyas.engine.policies.policy import PolicyInput as PolicyInput
    from eyas.engine.policies.policy import Start as Start
    from eyas.engine.policies.steering import towards as towards
    from eyas.engine.recordings.format import Format as Format
    from eyas.engine.recordings.recording import RecordedEpisode as RecordedEpisode
    from eyas.engine.recordings.recording import RecordedFrame as RecordedFrame
    from eyas.engine.recordings.recording import Recording as Recording
    from eyas.engine.recordings.recording import load as load
    from eyas.engine.sensors.sensor import Sensor as Sensor
    from eyas.engine.settings.config import EyasConfig as EyasConfig
    from eyas.engine.settings.file import load_settings as load_settings
    from eyas.engine.settings.section import Section as Section
    from eyas.engine.sim.build import build_simulation as build_simulation
    from eyas.engine.sim.config import SimConfig as SimConfig
    from eyas.engine.sim.flights.path import FlightScene as FlightScene
    from eyas.engine.sim.flights.path import FlightSketch as FlightSketch
    from eyas.engine.sim.serving import Face as Face
    from eyas.engine.sim.serving import Orders as Orders
    from eyas.engine.sim.serving import serve as serve
    from eyas.engine.sim.simulation import Simulation as Simulation
    from eyas.engine.sim.simulation import StepResult as StepResult
    from eyas.engine.sim.worlds import each_alone as each_alone
    from eyas.engine.sim.worlds import together as together
    from eyas.engine.state.draw import Picture as Picture
    from eyas.engine.state.mesh import Material as Material
    from eyas.engine.state.mesh import Mesh as Mesh
    from eyas.engine.state.roads import RoadEdge as RoadEdge
    from eyas.engine.state.roads import RoadGraph as RoadGraph
    from eyas.engine.state.roads import RoadNetwork as RoadNetwork
    from eyas.engine.state.roads import RoadNode as RoadNode
    from eyas.engine.state.scene import ObjectClass as ObjectClass
    from eyas.engine.state.scene import Scene as Scene
    from eyas.engine.state.snapshot import CameraState as CameraState
    from eyas.engine.state.snapshot import Snapshot as Snapshot
    from eyas.engine.state.snapshot import TrackerState as TrackerState
    from eyas.engine.state.terrain import Terrain as Terrain
    from eyas.engine.targets.grammar.attributes import ATTRIBUTES as ATTRIBUTES
    from eyas.engine.task.packets import BasicPacket as BasicPacket
    from eyas.engine.task.packets import InputPacket as InputPacket
    from eyas.engine.task.packets import RewardPacket as RewardPacket
    from eyas.engine.task.radar_packet import RadarPacket as RadarPacket
    from eyas.engine.task.step_line import StepLine as StepLine
    from eyas.engine.task.terms import RewardTerm as RewardTerm
    from eyas.engine.trackers.config import TrackerConfig as TrackerConfig
    from eyas.engine.trackers.flown import flown_drone as flown_drone
    from eyas.engine.trackers.tracker import Tracker as Tracker
    from eyas.engine.world.maps import MapRecipe as MapRecipe
    from eyas.engine.world.weather import CLEAR_DAY as CLEAR_DAY
    from eyas.engine.world.weather import DAY as DAY
    from eyas.engine.world.weather import Season as Season
    from eyas.engine.world.weather import Weather as Weather
    from eyas.lanes import kernel as kernel
    from eyas.learning.algorithm import Algorithm as Algorithm
    from eyas.learning.rollout import Rollout as Rollout
    from eyas.learning.run import train as train
    from eyas.maps.land.mounds import Mound as Mound
    from eyas.maps.osm.features import Survey as Survey
    from eyas.maps.plan.file import read_plan as read_plan
    from eyas.maps.plan.file import write_plan as write_plan
    from eyas.maps.plan.plan import Hills as Hills
    from eyas.maps.plan.plan import MapPlan as MapPlan

__version__: str
"""Version of this Eyas, by the tags of git (`tools/version.py`); "0" in a folder that is not
installed. `build_id` identifies the code exactly."""

build_id: str
"""Identity of code and data of this Eyas, see `eyas.engine.core.identity.build`: results of the
same build, settings and seed are the same to the bit."""

_PLACES = {
    "benchmark.api": "evaluate list_policies list_protocols",
    "benchmark.policies.box_trackers": "BoxTracker",
    "benchmark.protocols.table": "protocol_named",
    "dat.observation": "LegacyObservation",
    "datasets.api": "make_dataset track",
    "engine.api": "export make make_config make_vec record",
    "engine.core.clock": "PHYSICS_STEP",
    "engine.core.config": "Config updated",
    "engine.core.errors": (
        "ActionError ConfigError DataFileError EyasError MissingExtraError OutputError "
        "SpawnError UnknownNameError"
    ),
    "engine.core.files": "write_atomic",
    "engine.core.frames": "rotate rotate_back",
    "engine.custom.own": "Ride",
    "engine.envs.lerobot": "make_lerobot_env",
    "engine.envs.observation": "Observation",
    "engine.envs.pettingzoo": "EyasParallelEnv",
    "engine.envs.play": "hover_action",
    "engine.envs.registration": "register_map",
    "engine.envs.sb3": "EyasVecEnv",
    "engine.envs.tracking_env": "TrackingEnv",
    "engine.envs.vector_env": "EyasVectorEnv",
    "engine.exports.frame": "Frame",
    "engine.exports.label": "label_schema read_labels",
    "engine.exports.writer": "Episode EpisodeWriter Files Gather Run Summary Writer",
    "engine.mesh.shell": "Shell",
    "engine.names": "list_formats list_maps list_presets list_targets list_weathers",
    "engine.policies.policy": "Decision Policy PolicyInput Start",
    "engine.policies.steering": "towards",
    "engine.recordings.format": "Format",
    "engine.recordings.recording": "RecordedEpisode RecordedFrame Recording load",
    "engine.sensors.sensor": "Sensor",
    "engine.settings.config": "EyasConfig",
    "engine.settings.file": "load_settings",
    "engine.settings.section": "Section",
    "engine.sim.build": "build_simulation",
    "engine.sim.config": "SimConfig",
    "engine.sim.flights.path": "FlightScene FlightSketch",
    "engine.sim.serving": "Face Orders serve",
    "engine.sim.simulation": "Simulation StepResult",
    "engine.sim.worlds": "each_alone together",
    "engine.state.draw": "Picture",
    "engine.state.mesh": "Material Mesh",
    "engine.state.roads": "RoadEdge RoadGraph RoadNetwork RoadNode",
    "engine.state.scene": "ObjectClass Scene",
    "engine.state.snapshot": "CameraState Snapshot TrackerState",
    "engine.state.terrain": "Terrain",
    "engine.targets.grammar.attributes": "ATTRIBUTES",
    "engine.task.packets": "BasicPacket InputPacket RewardPacket",
    "engine.task.radar_packet": "RadarPacket",
    "engine.task.step_line": "StepLine",
    "engine.task.terms": "RewardTerm",
    "engine.trackers.config": "TrackerConfig",
    "engine.trackers.flown": "flown_drone",
    "engine.trackers.tracker": "Tracker",
    "engine.world.maps": "MapRecipe",
    "engine.world.weather": "CLEAR_DAY DAY Season Weather",
    "lanes": "kernel",
    "learning.algorithm": "Algorithm",
    "learning.run": "train",
    "learning.rollout": "Rollout",
    "maps.land.mounds": "Mound",
    "maps.osm.features": "Survey",
    "maps.plan.file": "read_plan write_plan",
    "maps.plan.plan": "Hills MapPlan",
}
"""Where the public names are. A test holds them equal to the imports above, which type checkers and
editors read."""

_MODULE_OF = {name: f"eyas.{module}" for module, names in _PLACES.items() for name in names.split()}

__all__ = ["__version__", "build_id", *_MODULE_OF]  # texts

_register()


def __getattr__(name: str) -> Any:  # noqa: ANN401  # a public name
    if name == "build_id":  # reads all files of the package, so only when it is asked for
        from eyas.engine.core.identity.build import this_build

        return this_build().id
    if name == "__version__":
        from eyas.engine.core.installed import installed_version

        return installed_version()
    if name in _MODULE_OF:
        from importlib import import_module
        from importlib.util import find_spec

        house = ".".join(_MODULE_OF[name].split(".")[:2])
        if find_spec(house) is None:  # a copy of the engine alone
            raise AttributeError(f"eyas.{name} is not here: it is of the house {house}")
        value = globals()[name] = getattr(import_module(_MODULE_OF[name]), name)
        return value
    raise AttributeError(f"module 'eyas' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(__all__)
