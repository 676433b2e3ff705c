"""What can be set and is not in this version yet: said in one line instead of ignored."""

from eyas.core.errors import NotInThisVersionError, UnknownNameError
from eyas.sim.config import EyasConfig, LightConfig, ObjectsConfig
from eyas.sim.legacy_model import TRACKING_OBJECTS
from eyas.trackers.config import TrackerKind

__all__ = ["require_supported"]


def require_supported(config: EyasConfig) -> None:
    """Refuse settings that ask for a part that this version does not have.

    Raises:
        NotInThisVersionError: One line that names the setting.
        UnknownNameError: The target does not exist at all.
    """
    if config.target not in TRACKING_OBJECTS:
        raise UnknownNameError("target (Tracking_Object)", config.target, TRACKING_OBJECTS)
    if config.target != "SUMO_VEHICLE":
        _refuse("target (Tracking_Object)", config.target, "targets other than vehicles")
    if config.tracker.kind is not TrackerKind.DRONE:
        _refuse("tracker.kind (Tracker_Def)", config.tracker.kind, "the car tracker")
    if not config.tracker.supervised:
        _refuse("tracker.supervised (Drone_Supervisor_Ctrl)", "false", "PID flight")
    if config.wire.lidar:
        _refuse("wire.lidar (Lidar_Enable)", "true", "the lidar")
    # When light is drawn does not matter while nothing is drawn.
    if config.light != LightConfig(each_reset=config.light.each_reset):
        _refuse("light (Env_Params)", "not the default", "changing light and fog")
    if config.objects != ObjectsConfig():
        _refuse("objects (Other_Params)", "not the default", "targets other than vehicles")


def _refuse(path: str, value: str, part: str) -> None:
    raise NotInThisVersionError(f"{path}: {value}: not in this version yet: {part}")
