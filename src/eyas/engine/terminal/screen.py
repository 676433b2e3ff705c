"""Whether windows of this machine can be seen."""

import os
import sys


def has_screen() -> bool:
    """Return whether a window could open: on Linux, whether a display server is named."""
    if sys.platform != "linux":
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
