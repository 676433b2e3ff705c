"""Pictures of the documents that no other sheet draws, from the settings that show their subject.

python tools/scene_sheet.py docs/images

Writes camera-lens.jpg, camera-shutter.jpg, camera-events.jpg, lidar.jpg, simpleway.jpg,
imported.jpg and town-crossings.jpg.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from air_sheet import seen
from camera_sheet import SIDE, Pixels, Row, drawn, sheet, simulation_of
from PIL import Image, ImageDraw
from weather_sheet import rotation

import eyas
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig

TURN = np.array([[0.0, 0.0, 0.0, 3.0]])  # Turn rate [rad/s]
STRAIGHT_DOWN = (math.pi / 2, math.pi / 2 - 1e-3)  # Yaw and pitch [rad]
STEPS = 20  # Physics steps before a picture of a motion


def lenses() -> list[Row]:
    """Return a pinhole, a barrel, and a fisheye with dark edges and fringes."""
    fisheye = {"model": "fisheye", "vignetting": 0.5, "red": 0.002, "blue": -0.002}
    cameras: dict[str, dict[str, object]] = {
        "pinhole": {},
        "brown, k1 = -0.28": {"lens": {"model": "brown", "k1": -0.28, "k2": 0.07}},
        "fisheye": {"field_of_view": 2.0, "lens": fisheye},
    }
    return [[(name, drawn(simulation_of({"samples": 4, **of}))) for name, of in cameras.items()]]


def moved(camera: dict[str, object], turn: bool) -> Pixels:
    """Return a picture of a camera that turns, or of a car that passes one that hovers."""
    across = {} if turn else {"start": {"direction": 1.57, "velocity": "rest"}}
    simulation = simulation_of({"samples": 4, **camera}, changes=across)
    simulation.advance(TURN if turn else 0.0 * TURN, STEPS)
    return drawn(simulation)


def shutters() -> list[Row]:
    """Return a turn, and a passing car: an instant, blurred, row by row."""
    cameras = {
        "an instant": {},
        "blur of 20 ms": {"shutter": {"blur": True, "exposure": 0.02}},
        "33 ms from row to row": {"shutter": {"readout": 0.033}},
    }
    return [[(name, moved(of, turn)) for name, of in cameras.items()] for turn in (True, False)]


def events() -> list[Row]:
    """Return a picture, and the events of turning and of hovering: more light red, less blue."""
    config = {
        "camera": {"events": {"enabled": True, "bins": 1, "width": 320, "height": 240}},
        "start": {"height": 13.0, "pitch": 0.75},
        "env": {"observation": {"parts": ["events"], "layout": "chw"}},
    }
    row = [("a picture", moved({}, turn=False))]
    for name, action in (("turning", 5), ("hovering", 0)):
        env = eyas.make("citystreet-day", config=config)
        env.reset(seed=0)
        less, more = env.step(action)[0].astype(float)
        shown = np.full((240, 320, 3), 24.0)
        shown[..., 0] += 90.0 * more
        shown[..., 2] += 90.0 * less
        row.append((f"events of {name}", np.clip(shown, 0, 255).astype(np.uint8)))
    return [row]


def view(map_name: str, weather: str, vehicle: int, height: float, pitch: float) -> Pixels:
    """Return 480x360 pixels of a map from above a vehicle."""
    world = StillWorld(load_assets(WorldConfig(map=map_name, weather=weather), TrafficConfig()))
    actors = world.actors(200.0)
    here = np.flatnonzero(actors.present[0])
    actor = here[vehicle % len(here)]
    turned = rotation(float(actors.yaw[0, actor]), pitch)
    eye = actors.position[0, actor] - turned[:, 0] * height / math.sin(pitch)
    one = np.zeros(1, np.int32)
    picture = Picture.create(1, 360, 480)
    world.draw(Views(eye[None], turned[None], one, one - 1, 1.1), 200.0, picture, 4)
    return picture.rgb[0]


def lidar() -> Image.Image:
    """Return a turn of the lidar of a car over the place around it, from straight above."""
    simulation = simulation_of({}, changes={"tracker": {"kind": "car"}, "lidar": {"enabled": True}})
    best, hits = None, -1
    for _ in range(40):
        ranges = simulation.view.lidar.ranges()[0].copy()
        if (near := int((ranges < 12.0).sum())) > hits:
            eye = simulation.snapshot.trackers.position[0] + [0.0, 0.0, 26.0]
            hits, best = near, (ranges, seen(simulation, eye, *STRAIGHT_DOWN))
            heading = float(simulation.snapshot.trackers.euler[0, 2])
        simulation.reset()
    ranges, pixels = best
    made = Image.fromarray(pixels).resize((960, 720))
    pen = ImageDraw.Draw(made)
    # Point 0 looks back, and the points follow clockwise; north is up.
    turn = heading + math.pi - 2.0 * math.pi * np.arange(len(ranges)) / len(ranges)
    metre = 480.0 / math.tan(0.55) / 26.0
    for away, angle in zip(ranges * metre, turn, strict=True):
        if away < 12.0 * metre:
            x, y = 480 + away * math.cos(angle), 360 - away * math.sin(angle)
            pen.line((480, 360, x, y), (230, 230, 230))
            pen.ellipse((x - 3, y - 3, x + 3, y + 3), (255, 210, 40))
    return made


def town(folder: Path) -> str:
    """Return the map of a town whose OpenStreetMap file is written into a folder."""
    tools = Path(__file__).parent
    file, place = folder / "town.osm", folder / "town"
    run = [sys.executable, str(tools / "synthetic_osm.py"), str(file), "--columns", "4"]
    subprocess.run([*run, "--rows", "4"], check=True)
    run = [sys.executable, "-m", "eyas", "maps", "import", str(file), "--out", str(place)]
    subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
    return os.fspath(place)


def imported(place: str) -> list[Row]:
    """Return an imported town in four weathers."""
    tiles = [
        (weather, view(place, weather, 3 + 5 * number, 35.0, 0.4))
        for number, weather in enumerate(("day", "foggy", "night", "snow"))
    ]
    return [tiles[:2], tiles[2:]]


def crossings(place: str) -> Image.Image:
    """Return people who cross a street of a town, as a recording shows them."""
    crowd = [{"kind": "Pedestrian", "count": 60, "behaviour": "crossing"}]
    simulation = simulation_of(
        {"samples": 4, "field_of_view": 1.1},
        changes={"world": {"map": place}, "extras": crowd, "target": "Pedestrian"},
    )
    shots: list[tuple[float, Pixels]] = []
    for _ in range(30):
        made = Picture.create(1, SIDE[1], SIDE[0], class_id=True)
        simulation.draw(np.zeros(1, np.int32), made)
        share = np.isin(made.class_id[0], (ObjectClass.MARKING, ObjectClass.PERSON)).mean()
        shots.append((float(share), made.rgb[0]))
        simulation.reset()
    best = sorted(shots, key=lambda shot: -shot[0])[:2]
    return Image.fromarray(np.concatenate([pixels for _, pixels in best], axis=1))


def main() -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="folder to write to")
    folder = parser.parse_args().folder
    sheet(folder / "camera-lens.jpg", lenses())
    sheet(folder / "camera-shutter.jpg", shutters())
    sheet(folder / "camera-events.jpg", events())
    lidar().save(folder / "lidar.jpg", quality=85)
    maps = ("simpleway-desert", "simpleway-farm")
    sheet(folder / "simpleway.jpg", [[(name, view(name, "day", 4, 30.0, 0.38)) for name in maps]])
    with tempfile.TemporaryDirectory() as scratch:
        place = town(Path(scratch))
        sheet(folder / "imported.jpg", imported(place))
        crossings(place).save(folder / "town-crossings.jpg", quality=85)


if __name__ == "__main__":
    main()
