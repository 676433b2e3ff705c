"""What can be set and is not in this version yet: said in one line instead of ignored."""

from collections.abc import Iterator

from eyas.core.config import Config, shown
from eyas.core.errors import NotInThisVersionError
from eyas.sim.config import EyasConfig, ObjectsConfig, TargetName
from eyas.sim.legacy.adapter import legacy_keys_of
from eyas.trackers.config import TrackerKind

__all__ = ["require_supported"]


def require_supported(config: EyasConfig) -> None:
    """Refuse settings that ask for a part that this version does not have.

    Maps and weathers are refused where they are looked up.

    Raises:
        NotInThisVersionError: One line that names the setting, in both notations.
    """
    for path, value, part in _missing(config):
        keys = legacy_keys_of(path)
        theirs = f" ({keys[0]})" if keys else ""
        raise NotInThisVersionError(
            f"{path}{theirs}: {shown(value)}: {part} is not in this version yet"
        )


def _missing(config: EyasConfig) -> Iterator[tuple[str, object, str]]:
    """Yield path, value and the part that it asks for."""
    if config.target is not TargetName.SUMO_VEHICLE:
        yield "target", config.target.value, "a target other than SUMO's vehicles"
    if config.tracker.kind is TrackerKind.CAR:
        yield "tracker.kind", config.tracker.kind.value, "the car as a tracker"
    if not config.tracker.supervised:
        yield "tracker.supervised", False, "flying by a flight controller"
    if config.wire.lidar:
        yield "wire.lidar", True, "the lidar"
    for path, value in _changed("objects", config.objects, ObjectsConfig()):
        yield path, value, "placing objects along the road"


def _changed(group: str, config: Config, default: Config) -> Iterator[tuple[str, object]]:
    for name in type(config).model_fields:
        value = getattr(config, name)
        if value != getattr(default, name):
            yield f"{group}.{name}", value
