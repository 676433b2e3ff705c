"""The devices that environments can be on, and what draws there."""

import re

from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import ConfigError
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.state.draw import Renderer
from eyas.gpu.render.device_views import DeviceDrawer, StagedDrawer
from eyas.gpu.sim.host_renderer import HostRenderer
from eyas.lanes.device import Device, HostDevice


def device_of(wanted: Device | str) -> Device:
    """Return a device.

    Args:
        wanted: The device, or its name: `cuda`, `cuda:1` and so on are graphics processors of
            NVIDIA, `host` is this processor, which does what these would do: for tests, since
            without a device environments are faster there.

    Raises:
        ConfigError: There is no such device, or it cannot be used.
    """
    if not isinstance(wanted, str):
        return wanted
    if wanted == "host":
        return HostDevice()
    card = re.fullmatch(r"cuda(?::(\d{1,4}))?", wanted)
    if card is None:
        raise ConfigError(
            f"device: '{wanted}' is not allowed: 'cuda', 'cuda:1' and so on, 'host', or None"
        )
    from eyas.gpu.cuda import CudaError, cuda_device  # for those who want it

    try:
        return cuda_device(int(card[1] or 0))
    except CudaError as error:
        raise ConfigError(f"device: '{wanted}' cannot be used: {error}") from error


def drawer_of(
    device: Device,
    renderer: Renderer,  # What draws the same on this processor
    camera: CameraConfig,  # Samples per pixel, and their filter
) -> DeviceDrawer:
    """Return what draws on a device."""
    if isinstance(device, HostDevice):
        return HostRenderer(renderer, camera.samples, tent=camera.tent)
    assert isinstance(renderer, CpuRenderer)
    return StagedDrawer(device, *renderer.packed, camera.samples, tent=camera.tent)
