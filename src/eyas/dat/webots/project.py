"""The files of a project of Webots."""

import io
import json
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from eyas.dat.settings.entries import WorldPath
from eyas.dat.settings.layout import original_defaults
from eyas.dat.webots.protos import (
    DRONE,
    INTERFACE,
    drone_proto,
    interface_proto,
    pool,
    vehicle_protos,
)
from eyas.dat.webots.vrml import Node, Value, world
from eyas.dat.webots.world import VrmlShapes, scene_nodes, sky_nodes
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import Scene
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE, MapRecipe
from eyas.maps.formats.registry import MapExport, MapFormat
from eyas.maps.formats.roads import sumo_files_of

_PROJECT = Path("Webots_Simulation", "traffic_project")
_PREFIX = "eyas.dat.webots.controllers."
_CONTROLLERS = {
    "global_receiver": ("ground",),
    "drone": ("ground", "tracking"),
    "sumo_supervisor": ("ground",),
}
"""What each imports."""
_WORLD = WorldPath("world", "map", "weather")


class Condition(NamedTuple):
    """Weather and hour of a world."""

    weather: str | None = None  # None: the map's first
    hour: float | None = None  # None: the weather's own


def run(name: str, seed: int, folder: Path, detail: int, condition: Condition) -> list[Path]:
    """Write a project; another weather of a map, or another map, may be written beside it.

    Args:
        folder: What holds `Webots_Simulation`; made if it does not exist.
        condition: Weather and hour.

    Returns:
        The world file, and the folders beside it.

    Raises:
        EyasError: SUMO is not installed, the map cannot be built, or a file not written.
    """
    recipe = MAPS.get(name)
    weather = condition.weather or recipe.weathers[0]
    light = recipe.light(weather, condition.hour)
    scene = load_scene(name, seed, recipe.season(weather))
    project = folder / _PROJECT
    told: dict[str, bytes] = dict(_world_files(scene, recipe, weather, light, detail))
    roads = f"worlds/{recipe.name}_net"
    for file, content in {**sumo_files_of(name, seed, "sumo"), **_ground(scene)}.items():
        told[f"{roads}/{file}"] = content
    told |= _controllers() | _settings(recipe.name, weather)
    if recipe.attribution():
        told[ATTRIBUTION_FILE] = recipe.attribution().encode()
    for path, content in told.items():
        with refusals(project / path):
            (project / path).parent.mkdir(parents=True, exist_ok=True)
        write_atomic(project / path, content)
    (project / "Files2Alg").mkdir(exist_ok=True)
    kept = [project / _world_of(recipe.name, weather), project / roads]
    return [*kept, *(project / part for part in ("protos", "controllers", "config"))]


def _world_of(name: str, weather: str) -> str:
    return str(_WORLD.write({"map": name, "weather": weather})["world"])


def _world_files(
    scene: Scene, recipe: MapRecipe, weather: str, light: Lighting, detail: int
) -> Iterator[tuple[str, bytes]]:
    """Yield the world, its PROTOs, and their textures, by path."""
    shining = light.lamps > 0.0
    shapes = {"": VrmlShapes("textures", lit=shining)}
    title = f"{recipe.name}, {weather}"
    nodes = sky_nodes(title, light, recipe.attribution())
    nodes += scene_nodes(scene, shapes[""], detail, shining=shining)
    nodes += _robots(recipe.name)
    nodes += [vehicle for vehicle, _ in pool()]
    protos = dict(vehicle_protos(shapes))
    camera = CameraConfig()
    protos[INTERFACE] = interface_proto()
    heads = [f"../protos/{name}.proto" for name in protos]
    text = world(heads, [f"../protos/{DRONE}.proto"], nodes)
    protos[DRONE] = drone_proto(camera.width, camera.height, 0.7854)
    yield _world_of(recipe.name, weather), text.encode()
    for name, content in protos.items():
        yield f"protos/{name}.proto", content.encode()
    textures = load_textures()
    for name in sorted(set().union(*(made.textures for made in shapes.values()))):
        png = io.BytesIO()
        Image.fromarray(np.ascontiguousarray(textures[name])).save(png, format="PNG")
        yield f"worlds/textures/{name}.png", png.getvalue()


def _robots(name: str) -> list[Node]:
    receiver: dict[str, Value] = {
        "name": "global_receiver",
        "controller": "global_receiver",
        "supervisor": True,
    }
    roads: dict[str, Value] = {"networkFiles": f"{name}_net", "maxVehicles": 40}
    return [Node("Robot", receiver, "GLOBAL_RECEIVER"), Node(INTERFACE, roads, "SUMO_INTERFACE")]


def _ground(scene: Scene) -> dict[str, bytes]:
    """Return the heights of the ground for controllers."""
    terrain = scene.terrain
    relief = np.rint(terrain.relief.astype(np.float64) * 1e4) / 1e4
    told = {
        "floor": terrain.floor, "west": terrain.west, "south": terrain.south,
        "spacing": terrain.spacing, "relief": relief.tolist(),
    }  # fmt: skip
    return {"ground.json": json.dumps(told).encode()}


def _controllers() -> dict[str, bytes]:
    """Return the controllers, each in a folder with what it imports."""
    source = files("eyas.dat.webots.controllers")
    told = {}
    for name, imported in _CONTROLLERS.items():
        for part in (name, *imported):
            text = source.joinpath(f"{part}.py").read_text(encoding="utf-8")
            told[f"controllers/{name}/{part}.py"] = text.replace(_PREFIX, "").encode()
    return told


def _settings(name: str, weather: str) -> dict[str, bytes]:
    """Return `env_config.json`, and the copy that controllers take what it leaves out from."""
    given = {**original_defaults(), "Simulation_Mode": "train"}
    given["World_Path"] = _world_of(name, weather)
    text = json.dumps(given, indent=2).encode() + b"\n"
    return {f"config/{file}.json": text for file in ("env_config", "env_config_backup")}


def _written(path: Path, options: MapExport) -> Iterator[str]:
    condition = Condition(options.weather, options.hour)
    yield from map(str, run(options.name, options.seed, path, options.detail, condition))


WEBOTS = MapFormat("-webots", _written)  # a folder: a project of Webots, laid out as the original's
