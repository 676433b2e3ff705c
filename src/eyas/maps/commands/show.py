"""A picture of a map from above: hills, streets, water, buildings, trees, and driven ways."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from rich.console import Console

from eyas.engine.core.files import atomic_path
from eyas.engine.sim.scenes import load_scene
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.terrain import reliefs
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.library import known_recording
from eyas.engine.world.maps import MAPS

_MARGIN = 60.0  # Around streets and buildings [m]
_SHARP = 2  # The picture is drawn this much larger, and made smaller at the end
_PAPER, _BUILDING, _EDGE = (244, 243, 238), (176, 168, 160), (128, 120, 114)
_TREE, _TRACK = (122, 168, 104), (206, 66, 40)
_SUN = np.array([-0.53, 0.53, 0.66])
"""Direction to the sun of the hills, north-west as on printed maps."""
_GROUND = {
    ObjectClass.ROAD: (120, 122, 128),
    ObjectClass.PAVEMENT: (214, 210, 202),
    ObjectClass.WATER: (134, 176, 214),
    ObjectClass.STRUCTURE: (190, 184, 178),
}
"""Colours of what is flat, by its class."""

Points = NDArray[np.float64]


def run(name: str, seed: int, path: Path, width: int, *, tracks: bool) -> None:
    """Draw a map from above into a PNG file.

    Args:
        width: Width of the picture [pixels].
        tracks: Whether the ways of the recorded cars are drawn; a line says where none are.

    Raises:
        EyasError: The map cannot be built, or the file not written.
    """
    scene = load_scene(name, seed)
    driven = _driven(name, seed) if tracks else []
    if tracks and not driven:
        note = "without the ways of its cars, which are recorded on first use"
        Console(stderr=True).print(note, markup=False, soft_wrap=True)
    with atomic_path(path) as part:
        _picture(scene, driven, width, _notice(name)).save(part, format="PNG")


def _driven(name: str, seed: int) -> list[Points]:
    recipe = MAPS.get(name)
    config, shipped = TrafficConfig(seed=None), recipe.shipped_traffic()
    recording = known_recording(recipe.roads(seed), config, shipped)
    if recording is None:
        return []
    return [
        recording.position[low:high, car]
        for car in range(recording.actors)
        for low, high in _runs(recording.present[:, car])
    ]


def _notice(name: str) -> str:
    """Return the first line of a map's attribution, or nothing."""
    return (MAPS.get(name).attribution().splitlines() or [""])[0]


def _runs(there: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the ranges of samples in which an actor is in the world."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(change[::2], change[1::2], strict=True) if b - a > 1]


class _Paper:
    """A picture under construction, with the frame from metres to pixels."""

    def __init__(self, scene: Scene, width: int) -> None:
        low, high = _bounds(scene)
        self.scale = width * _SHARP / (high[0] - low[0])
        self.low, self.high = low, high
        size = np.ceil((high - low) * self.scale).astype(int)
        self.image = Image.new("RGB", (int(size[0]), int(size[1])), _PAPER)
        self.draw = ImageDraw.Draw(self.image)

    def at(self, points: Points) -> list[tuple[float, float]]:
        """Return pixels, the first row in the north."""
        flat = np.asarray(points, np.float64)[:, :2]
        x = (flat[:, 0] - self.low[0]) * self.scale
        y = (self.high[1] - flat[:, 1]) * self.scale
        return list(zip(x.tolist(), y.tolist(), strict=True))


def _bounds(scene: Scene) -> tuple[Points, Points]:
    every = np.concatenate([scene.network.lane_points, scene.colliders.prism_points])
    half = np.array(scene.size) / 2
    if not len(every):
        return -half, half
    return (
        np.maximum(every.min(axis=0) - _MARGIN, -half),
        np.minimum(every.max(axis=0) + _MARGIN, half),
    )


def _picture(scene: Scene, driven: list[Points], width: int, notice: str) -> Image.Image:
    paper = _Paper(scene, width)
    if scene.terrain.relief.size:
        paper.image.paste(_hills(scene, paper))
    kinds = scene.object_class[scene.static_object]
    corners = scene.static.positions[scene.static.triangles]
    ground = scene.terrain.floor + reliefs(scene.terrain, corners[..., :2].astype(np.float64))
    level = (corners[..., 2] - ground).max(axis=1) < 1.0
    for kind in (ObjectClass.STRUCTURE, ObjectClass.WATER, ObjectClass.PAVEMENT, ObjectClass.ROAD):
        for triangle in corners[level & (kinds == kind)]:
            paper.draw.polygon(paper.at(triangle), fill=_GROUND[kind])
    for crown in _crowns(scene):
        paper.draw.polygon(paper.at(crown), fill=_TREE)
    solids = scene.colliders
    for solid, (low, high) in enumerate(pairwise(solids.prism_first)):
        kind = scene.object_class[solids.prism_object[solid]]
        fill = _BUILDING if kind == ObjectClass.BUILDING else _GROUND[ObjectClass.STRUCTURE]
        outline = paper.at(solids.prism_points[low:high])
        paper.draw.polygon(outline, fill=fill, outline=_EDGE, width=_SHARP)
    for track in driven:
        paper.draw.line(paper.at(track), fill=_TRACK, width=_SHARP, joint="curve")
    _legend(paper, notice)
    height = round(paper.image.height / _SHARP)
    return paper.image.resize((width, height), Image.Resampling.BOX)


def _hills(scene: Scene, paper: _Paper) -> Image.Image:
    """Return the ground in the light of a low sun."""
    size = np.array(paper.image.size) // (2 * _SHARP)  # a coarse picture: hills are smooth
    east = np.linspace(paper.low[0], paper.high[0], size[0])
    north = np.linspace(paper.high[1], paper.low[1], size[1])
    heights = reliefs(scene.terrain, np.stack(np.meshgrid(east, north), axis=-1))
    up, along = np.gradient(heights, north, east)
    normal = np.stack([-along, -up, np.ones_like(up)], axis=-1)
    light = normal @ _SUN / np.linalg.norm(normal, axis=-1) / _SUN[2]
    tone = np.clip(0.45 + 0.55 * light, 0.5, 1.05)
    shaded = np.minimum(tone[..., None] * np.array(_PAPER), 255.0).astype(np.uint8)
    return Image.fromarray(shaded).resize(paper.image.size, Image.Resampling.BICUBIC)


def _crowns(scene: Scene) -> Iterator[Points]:
    """Yield the outlines of trees, or of stands of trees, as seen from above [m]."""
    fixtures = scene.fixtures
    trees = np.flatnonzero(scene.object_class[fixtures.object_id] == ObjectClass.TREE)
    hulls: dict[int, Points] = {}
    for copy in trees.tolist():
        prototype = int(fixtures.prototype[copy])
        if prototype not in hulls:
            shape = shapely.MultiPoint(fixtures.levels[prototype][-1].positions[:, :2])
            hulls[prototype] = shapely.get_coordinates(shape.convex_hull)
        pose = fixtures.pose[copy].astype(np.float64)
        yield hulls[prototype] @ pose[:2, :2].T + pose[:2, 3]


def _legend(paper: _Paper, notice: str) -> None:
    """Draw a bar of 100 m, and the notice of whose data it is."""
    x, y, size = 24.0, paper.image.height - 30.0, 100.0 * paper.scale
    paper.draw.line([(x, y), (x + size, y)], fill=(30, 30, 30), width=3 * _SHARP)
    for place, text, anchor in (
        ((x, y - 8), "100 m", "ld"),
        ((paper.image.width - 24, y + 8), notice, "rd"),
    ):
        paper.draw.text(place, text, fill=(30, 30, 30), anchor=anchor, font_size=13 * _SHARP)
