"""What the demo's server gives on request: the files of the page, the map, the settings."""

import json
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from eyas.modes.demo.cockpit import Cockpit
from eyas.settings.legacy.adapter import to_legacy

__all__ = ["File", "own_file", "page_file"]

PAGE = Path(str(files("eyas.modes.demo"))) / "page"

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}

File = tuple[str, bytes]
"""Its type, and its bytes."""


@cache
def _names() -> dict[str, Path]:
    return {f"/{path.name}": path for path in PAGE.iterdir() if path.suffix in _TYPES}


def page_file(path: str) -> File | None:
    """Return a file of the page; None if there is none with this path."""
    found = _names().get("/index.html" if path == "/" else path)
    return None if found is None else (_TYPES[found.suffix], found.read_bytes())


def own_file(path: str, cockpit: Cockpit) -> File | None:
    """Return what is made on request: `/map.json` and `/env_config.json`.

    Raises:
        ConfigError: The original's keys cannot express the settings.
    """
    if path == "/map.json":
        return "application/json", json.dumps(_streets(cockpit)).encode()
    if path == "/env_config.json":
        text = json.dumps(to_legacy(cockpit.flight.config), indent=4)
        return "application/json", f"{text}\n".encode()
    return None


def _streets(cockpit: Cockpit) -> dict[str, Any]:
    """Return the middle lines of all lanes [m], and the width of each."""
    network = cockpit.flight.world.assets.scene.network
    lanes = np.split(np.round(network.lane_points, 1), network.lane_first[1:-1])
    return {
        "lanes": [lane.tolist() for lane in lanes],
        "widths": np.round(network.lane_width, 1).tolist(),
    }
