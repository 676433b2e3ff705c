"""How often a detector trained on photographs calls the target vehicle a vehicle, from the air.

python tools/judge_cars.py "COMMAND" ["COMMAND" ...] --views 96 --seed 7 --save build/judge

Each COMMAND is a detector. It gets a folder of pictures (PPM, 640x480) as its last argument, and
prints a line of JSON for each: {"name": "000", "boxes": [["car", 0.61, left, top, right, bottom]]}
with names of COCO's classes and pixels. None ships with Eyas: this is a measure, not a part.
"""

import argparse
import json
import math
import shlex
import subprocess
import tempfile
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.traffic.config import TrafficConfig, VehicleType
from eyas.engine.world.config import WorldConfig

MAPS = ("citystreet", "downtown", "lake", "village", "desert", "farmland")
PITCH = {6: 0.35, 13: 0.8, 22: 1.1, 40: 1.3}
"""Pitch down [rad] at each height of the camera above the target [m]."""
SIZE = (480, 640)
FOCAL = 320.0 / math.tan(math.pi / 8)  # Of a picture that is 45 degrees wide [pixels]
VEHICLES = {"car", "truck", "bus", "motorcycle"}
SCORE, OVERLAP, VISIBLE = 0.12, 0.5, 0.9


class View(NamedTuple):
    """A picture of a target."""

    rgb: np.ndarray
    box: tuple[int, ...]
    """Left, top, right and bottom of the target [pixels]."""
    name: str
    """Map and side."""


def rotation(yaw: float, pitch: float) -> np.ndarray:
    """Return camera to world: columns forward, left, up."""
    level = math.cos(pitch)
    forward = [math.cos(yaw) * level, math.sin(yaw) * level, -math.sin(pitch)]
    left = [-math.sin(yaw), math.cos(yaw), 0.0]
    return np.stack([forward, left, np.cross(forward, left)], axis=1)


def view(
    eye: np.ndarray,  # Optical centre [m]
    turned: np.ndarray,  # Camera to world
    target: int,  # The actor whose box is asked for
    field_of_view: float = math.pi / 4,  # [rad]
) -> Views:
    """Return one view."""
    return Views(
        position=eye[None],
        rotation=turned[None],
        world=np.zeros(1, np.int32),
        subject=np.full(1, ACTOR_OBJECT + target, np.int32),
        field_of_view=field_of_view,
        instant=np.zeros(1),
    )


def looked_at(
    world: StillWorld, time: float, target: int, turned: np.ndarray, away: float, name: str
) -> View | None:
    """Return a view of a vehicle `away` metres ahead; None: less than `VISIBLE` of it shows."""
    picture = Picture.create(1, *SIZE, subject=True)
    eye = world.actors(time).position[0, target] - turned[:, 0] * away
    world.draw(view(eye, turned, target), time, picture, 4)
    visible, whole = picture.subject_pixels[0]
    left, top, right, bottom = (int(edge) for edge in picture.subject_box[0])
    inside = left and top and right < SIZE[1] and bottom < SIZE[0]
    if whole == 0 or visible < VISIBLE * whole or not inside:
        return None
    return View(picture.rgb[0], (left, top, right, bottom), name)


def sampled(world: StillWorld, height: int, behind: bool, rng: np.random.Generator) -> View | None:
    """Return a view of a random vehicle at a random time; None: too little of it shows."""
    time = float(rng.uniform(30.0, 500.0))
    actors = world.actors(time)
    target = int(rng.choice(np.flatnonzero(actors.present[0])))
    yaw = float(actors.yaw[0, target] if behind else rng.uniform(-math.pi, math.pi))
    turned = rotation(yaw, PITCH[height])
    away = height / math.sin(PITCH[height])
    return looked_at(world, time, target, turned, away, "behind" if behind else "side")


def views_of(
    map_name: str, height: int, count: int, seed: int, kind: str, weather: str = "day"
) -> list[View]:
    """Return views of a map, half of them from behind."""
    mix = TrafficConfig(vehicle_type=VehicleType(kind)) if kind else TrafficConfig()
    assets = load_assets(WorldConfig(map=map_name, weather=weather), mix)
    rng = np.random.default_rng([seed, height, MAPS.index(map_name)])
    found: list[View] = []
    while len(found) < count:
        world = StillWorld(assets, int(rng.integers(1 << 30)))
        drawn = sampled(world, height, len(found) % 2 == 0, rng)
        if drawn is not None:
            found.append(drawn._replace(name=f"{map_name} {drawn.name}"))
    return found


def views_at(
    map_name: str, pitch: float, longest: int, count: int, seed: int, weather: str = "day"
) -> list[View]:
    """Return views of vehicles whose boxes are about `longest` pixels long, any side to the camera.

    A second picture corrects the distance of the first.
    """
    assets = load_assets(WorldConfig(map=map_name, weather=weather), TrafficConfig())
    rng = np.random.default_rng([seed, round(100 * pitch), MAPS.index(map_name)])
    found: list[View] = []
    while len(found) < count:
        world = StillWorld(assets, int(rng.integers(1 << 30)))
        time = float(rng.uniform(30.0, 500.0))
        target = int(rng.choice(np.flatnonzero(world.actors(time).present[0])))
        turned = rotation(float(rng.uniform(-math.pi, math.pi)), pitch)
        away = 4.5 * FOCAL / longest
        first = looked_at(world, time, target, turned, away, map_name)
        if first is not None:
            left, top, right, bottom = first.box
            away *= max(right - left, bottom - top) / longest
            second = looked_at(world, time, target, turned, away, map_name)
            found += [second] if second is not None else []
    return found


def overlap(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    """Return the intersection over the union of two boxes."""
    wide = min(one[2], other[2]) - max(one[0], other[0])
    high = min(one[3], other[3]) - max(one[1], other[1])
    both = max(wide, 0.0) * max(high, 0.0)
    areas = [(box[2] - box[0]) * (box[3] - box[1]) for box in (one, other)]
    return both / (sum(areas) - both)


def names_of(command: str, views: list[View]) -> list[list[tuple[str, float]]]:
    """Return what a detector calls the target of each view, with scores, the surest first."""
    with tempfile.TemporaryDirectory() as folder:
        for index, view in enumerate(views):
            Image.fromarray(view.rgb).save(Path(folder) / f"{index:03}.ppm")
        called = [*shlex.split(command), folder]
        lines = subprocess.run(called, capture_output=True, text=True, check=True).stdout
    names: list[list[tuple[str, float]]] = [[] for _ in views]
    for line in lines.splitlines():
        answer = json.loads(line)
        index = int(answer["name"])
        for name, score, *box in answer["boxes"]:
            if score >= SCORE and overlap(tuple(box), views[index].box) >= OVERLAP:
                names[index].append((name, score))
    return [sorted(of, key=lambda found: -found[1]) for of in names]


def wilson(hits: int, of: int) -> str:
    """Return a share in percent with its 95 % interval."""
    z, share = 1.96, hits / of
    middle = (share + z * z / (2 * of)) / (1 + z * z / of)
    half = z * math.sqrt(share * (1 - share) / of + z * z / (4 * of * of)) / (1 + z * z / of)
    return f"{100 * share:.0f} ({100 * (middle - half):.0f} to {100 * (middle + half):.0f})"


def report(height: int, views: list[View], named: list[list[tuple[str, float]]]) -> str:
    """Return a line on a height, as a detector sees it."""
    any_vehicle = [any(name in VEHICLES for name, _ in of) for of in named]
    surest = [bool(of) and of[0][0] in VEHICLES for of in named]
    sure = [any(name in VEHICLES and score >= 0.3 for name, score in of) for of in named]
    behind = [k for k, view in enumerate(views) if view.name.endswith("behind")]
    side = [k for k, view in enumerate(views) if not view.name.endswith("behind")]
    wrong = Counter(of[0][0] if of else "nothing" for of in named)
    wrong = Counter({name: count for name, count in wrong.items() if name not in VEHICLES})
    parts = [
        f"{height} m, n {len(views)}: a vehicle {wilson(sum(any_vehicle), len(views))} %",
        f"behind {wilson(sum(any_vehicle[k] for k in behind), len(behind))}",
        f"any side {wilson(sum(any_vehicle[k] for k in side), len(side))}",
        f"surest word {wilson(sum(surest), len(views))}",
        f"score >= .3 {wilson(sum(sure), len(views))}",
        f"found {wilson(sum(map(bool, named)), len(views))}",
        f"wrong {dict(wrong.most_common(5))}",
    ]
    return "; ".join(parts)


def main() -> None:
    """Draw the views and print a line for each detector and height."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("detector", nargs="+", help="commands, see above")
    parser.add_argument("--views", type=int, default=72, help="views a height")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--heights", type=int, nargs="+", default=list(PITCH))
    parser.add_argument("--vehicle", default="", help="kind of vehicle, as traffic.vehicle")
    parser.add_argument("--save", type=Path, help="folder for the pictures")
    chosen = parser.parse_args()
    each = chosen.views // len(MAPS)
    for height in chosen.heights:
        views = [
            view
            for name in MAPS
            for view in views_of(name, height, each, chosen.seed, chosen.vehicle)
        ]
        judged = [names_of(command, views) for command in chosen.detector]
        for command, named in zip(chosen.detector, judged, strict=True):
            print(command, report(height, views, named), sep="\n  ", flush=True)
        if chosen.save:
            save(chosen.save / f"{height}", views, judged)


def save(folder: Path, views: list[View], judged: list[list[list[tuple[str, float]]]]) -> None:
    """Write the pictures, and what was said of each."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "said.jsonl").open("w") as said:
        for index, view in enumerate(views):
            Image.fromarray(view.rgb).save(folder / f"{index:03}.png")
            words = [named[index] for named in judged]
            said.write(json.dumps([index, view.name, view.box, words]) + "\n")


if __name__ == "__main__":
    main()
