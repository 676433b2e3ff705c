"""The devices that environments can be on."""

from collections.abc import Callable
from typing import NamedTuple

from eyas.core.errors import ConfigError
from eyas.lanes.device import Device, HostDevice
from eyas.render.device_views import DeviceRenderer
from eyas.sim.device.host_renderer import HostRenderer
from eyas.state.draw import Renderer

__all__ = ["DEVICES", "DeviceKind", "device_of"]


class DeviceKind(NamedTuple):
    """A kind of device."""

    make: Callable[[], Device]
    """Returns one."""
    renderer: Callable[[Device, Renderer, int], DeviceRenderer]
    """Returns what draws there, for a renderer of this processor and samples per pixel."""


def _on_host(device: Device, renderer: Renderer, samples: int) -> DeviceRenderer:
    return HostRenderer(renderer, samples)


DEVICES = {"host": DeviceKind(HostDevice, _on_host)}
"""By `Device.name`. `host` is this processor, which does what a graphics processor would do: for
tests, since without a device environments are faster there."""


def device_of(wanted: Device | str) -> tuple[Device, DeviceKind]:
    """Return a device, and its kind.

    Args:
        wanted: The device, or its name.

    Raises:
        ConfigError: There is no such device.
    """
    name = wanted if isinstance(wanted, str) else wanted.name
    if name not in DEVICES:
        allowed = ", ".join(f"'{known}'" for known in DEVICES)
        raise ConfigError(f"device: '{name}' is not allowed: {allowed}, a device, or None")
    return (DEVICES[name].make() if isinstance(wanted, str) else wanted), DEVICES[name]
