"""How Eyas looks beside photographs: tones, contrast, colours, edges, texture, flicker, detectors.

python tools/looks_bench.py --out build/looks --seed 7                   # ours alone, by day
python tools/looks_bench.py --real FOLDER --detector "COMMAND" ...       # beside photographs
python tools/looks_bench.py --weathers day night --before OLD/looks.json # what a change did
python tools/write_docs.py                 # after `cp build/looks/looks.json bench/looks.json`

Writes `looks.json`, `looks.md` (one page) and `looks.png` (a row of pictures for each map and
weather; photographs on top) into the folder. FOLDER holds photographs from the air (JPEG, PNG) and,
for detectors, `cars.json`: [{"picture": name, "view": "oblique", "front" or "down",
"box": [left, top, right, bottom]}, ...]. None ships with Eyas, nor does a detector: both are for
measuring only. What COMMAND must do stands in `judge_cars.py`. Judge a change by a seed that it was
not tuned on.
"""

import argparse
import io
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import judge_cars as judge
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from eyas.engine.core.identity.build import this_build
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture
from eyas.engine.state.scene import ObjectClass
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig

Image8 = NDArray[np.uint8]  # RGB, shape (H, W, 3)
Figures = dict[str, float]

LOOKS = {"street": (12.0, 0.35), "far": (45.0, 0.18), "high": (80.0, 0.95), "near": (13.0, 0.8)}
"""Height above a vehicle [m] and pitch down [rad] of the camera of each picture that is measured,
straight behind the vehicle."""
PITCHES = {"down": math.pi / 2 - 0.02, "steep": math.pi / 2 - 0.38, "oblique": 0.35}
"""Pitch down [rad] of the views for detectors. Photographs that were taken straight down show their
marked cars 15 to 34 degrees beside the nadir: `steep` compares with them."""
WIDTH, SIZE = 640, (480, 640)
LUMA = np.array((0.299, 0.587, 0.114))
WINDOW = 24  # Side of a patch of ground [pixels]
DIGITS = {"edges": 1, "colours": 0, "p5": 0, "p95": 0}


def measured(rgb: Image8) -> Figures:
    """Return the statistics of a picture that is 640 pixels wide.

    p5, p95: 5 % and 95 % quantiles of luma. colours: number of the 4,096 colours of four bits a
    channel that make 90 % of it. edges: share of pixels [%] whose gradient is more than 12 levels a
    pixel. slope: exponent of the power spectrum. jpeg: bits a pixel at quality 90. noise: standard
    deviation [levels] of the calmest 30 % (Immerkaer, Fast noise variance estimation, 1996).
    """
    luma = rgb @ LUMA
    gradient = np.hypot(*(np.gradient(luma, axis=axis) for axis in (0, 1)))
    bins = rgb.astype(np.int64) >> 4
    counts = np.sort(np.bincount((bins @ (256, 16, 1)).ravel(), minlength=4096))[::-1]
    calm = gradient[1:-1, 1:-1] < np.quantile(gradient, 0.3)
    across = luma[:, :-2] - 2.0 * luma[:, 1:-1] + luma[:, 2:]
    laplacian = across[:-2] - 2.0 * across[1:-1] + across[2:]
    packed = io.BytesIO()
    Image.fromarray(rgb).save(packed, "JPEG", quality=90)
    return {
        "p5": float(np.quantile(luma, 0.05)),
        "p95": float(np.quantile(luma, 0.95)),
        "colours": float((np.cumsum(counts) < 0.9 * counts.sum()).sum() + 1),
        "edges": float(100.0 * (gradient > 12.0).mean()),
        "slope": spectral_slope(luma),
        "jpeg": 8.0 * len(packed.getvalue()) / luma.size,
        "noise": float(np.median(np.abs(laplacian[calm])) / 0.6745 / 6.0) if calm.any() else 0.0,
    }


def spectral_slope(luma: NDArray[np.float64]) -> float:
    """Return the slope of the radial power spectrum of the middle square, in log over log."""
    side = min(luma.shape) // 2 * 2
    top, left = ((length - side) // 2 for length in luma.shape)
    square = luma[top : top + side, left : left + side]
    square = (square - square.mean()) * np.outer(np.hanning(side), np.hanning(side))
    power = np.abs(np.fft.fftshift(np.fft.fft2(square))) ** 2
    radius = np.hypot(*(np.indices(power.shape) - side // 2)).round().astype(int)
    ring = np.bincount(radius.ravel(), power.ravel()) / np.bincount(radius.ravel())
    band = np.arange(int(0.03 * side), int(0.4 * side))
    return float(np.polyfit(np.log(band), np.log(ring[band] + 1e-9), 1)[0])


def patches(rgb: Image8, of: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return mean and standard deviation of luma in each window wholly of a ground, in sunlight.

    Shape (., 2). In sunlight: no darker on average than .7 times the brightest tenth.
    """
    luma, found = rgb @ LUMA, []
    for top in range(0, luma.shape[0] - WINDOW, WINDOW // 2):
        for left in range(0, luma.shape[1] - WINDOW, WINDOW // 2):
            window = np.s_[top : top + WINDOW, left : left + WINDOW]
            if of[window].all():
                found.append((luma[window].mean(), luma[window].std()))
    made = np.array(found).reshape(-1, 2)
    return made[made[:, 0] >= 0.7 * np.quantile(made[:, 0], 0.9)] if len(made) else made


def grounds(picture: Picture) -> dict[str, NDArray[np.float64]]:
    """Return `patches` of road and of green ground (lawns, meadows, crops)."""
    rgb, classes = picture.rgb[0], picture.class_id[0]
    red, green, blue = np.moveaxis(rgb.astype(float), -1, 0)
    grass = (classes == ObjectClass.GROUND) & (green > 0.97 * red) & (green > 1.08 * blue)
    whole = (classes == ObjectClass.GROUND) & (blurred(grass) > 0.7)
    return {"road": patches(rgb, classes == ObjectClass.ROAD), "lawn": patches(rgb, whole)}


def blurred(mask: NDArray[np.bool_], reach: int = 8) -> NDArray[np.float64]:
    """Return the share of a mask in the square of 2 `reach` + 1 pixels around each pixel."""
    summed = np.pad(mask.astype(float), reach + 1, mode="edge").cumsum(0).cumsum(1)
    side = 2 * reach + 1
    rows = summed[side:] - summed[:-side]
    return ((rows[:, side:] - rows[:, :-side]) / side**2)[:-1, :-1]


def looks(world: StillWorld, count: int, rng: np.random.Generator) -> Iterator[tuple[str, Picture]]:
    """Yield `count` pictures of each kind of `LOOKS` whose vehicle is visible, with the kind."""
    for name, (height, pitch) in LOOKS.items():
        left, tries = count, 0
        while left and tries < 40 * count:
            tries += 1
            time = float(rng.uniform(30.0, 500.0))
            actors = world.actors(time)
            target = int(rng.choice(np.flatnonzero(actors.present[0])))
            turned = judge.rotation(float(actors.yaw[0, target]), pitch)
            away = min(height / math.sin(pitch), 130.0)
            eye = actors.position[0, target] - turned[:, 0] * away
            views = judge.view(eye, turned, target, field_of_view=1.1)
            picture = Picture.create(1, *SIZE, subject=True, class_id=True)
            world.draw(views, time, picture, 4)
            visible, whole = picture.subject_pixels[0]
            if whole and visible >= 0.5 * whole:
                left -= 1
                yield name, picture


def flicker(world: StillWorld, rng: np.random.Generator, places: int = 3) -> Figures:
    """Return the 99.9 % quantile of second differences of 84x84 pictures with one sample [levels].

    A camera that creeps by 2 cm a picture, and one that turns by .002 rad, in a still world.
    """
    moves = {"creep": (0.02, 0.0, 1.0), "pan": (0.0, 0.002, 0.5)}  # m, rad, pitch [rad]
    found: dict[str, list[float]] = {name: [] for name in moves}
    for _ in range(places):
        time = float(rng.uniform(30.0, 500.0))
        actors = world.actors(time)
        target = int(rng.choice(np.flatnonzero(actors.present[0])))
        yaw = float(actors.yaw[0, target])
        ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
        eye = actors.position[0, target] - 12.0 * ahead + [0.0, 0.0, 19.0]
        for name, (step, turn, pitch) in moves.items():
            film = []
            for k in range(14):
                turned = judge.rotation(yaw + turn * k, pitch)
                views = judge.view(eye + step * k * ahead, turned, target)
                picture = Picture.create(1, 84, 84)
                world.draw(views, time, picture, 1)
                film.append(picture.rgb[0].astype(np.int16))
            second = np.abs(np.diff(np.array(film), 2, axis=0)).max(axis=-1)
            found[name].append(float(np.quantile(second, 0.999)))
    return {name: float(np.mean(values)) for name, values in found.items()}


def averages(figures: list[Figures]) -> Figures:
    """Return the means of each figure."""
    return {name: float(np.mean([one[name] for one in figures])) for name in figures[0]}


def of_place(map_name: str, weather: str, seed: int, count: int) -> tuple[Figures, list[Image8]]:
    """Return the figures of a map in a weather, and its pictures."""
    world = StillWorld(
        load_assets(WorldConfig(map=map_name, weather=weather), TrafficConfig()), seed
    )
    pictures = list(looks(world, count, np.random.default_rng([seed, 1])))
    figures = averages([measured(picture.rgb[0]) for _, picture in pictures])
    # Photographs of lawns, which these compare with, were taken from near by.
    found = [grounds(picture) for name, picture in pictures if name != "far"]
    road, lawn = (np.concatenate([one[name] for one in found]) for name in ("road", "lawn"))
    if len(road):
        figures |= {"road": float(np.median(road[:, 0])), "road std": float(np.median(road[:, 1]))}
    if len(lawn) > 20:
        figures |= {"lawn": float(np.median(lawn[:, 0])), "lawn std": float(np.median(lawn[:, 1]))}
        figures["lawn/road"] = figures["lawn"] / figures.get("road", math.nan)
    figures |= flicker(world, np.random.default_rng([seed, 2]))
    return figures, [picture.rgb[0] for _, picture in pictures]


def photographs(folder: Path) -> tuple[Figures, list[Image8]]:
    """Return the figures of the photographs in a folder, 640 pixels wide each."""
    found = []
    for path in sorted(path for path in folder.iterdir() if path.suffix in (".jpg", ".png")):
        photograph = Image.open(path).convert("RGB")
        height = round(photograph.height * WIDTH / photograph.width)
        found.append(np.asarray(photograph.resize((WIDTH, height), Image.Resampling.BOX)))
    return averages([measured(rgb) for rgb in found]), found


def marked_cars(folder: Path, longest: int) -> list[judge.View]:
    """Return photographs of marked cars, each `longest` pixels long in a picture of 640x480.

    What lies straight down is turned four ways, as it has no upper side.
    """
    found = []
    for car in json.loads((folder / "cars.json").read_text()):
        photograph = Image.open(folder / car["picture"]).convert("RGB")
        for turn in range(4 if car["view"] == "down" else 1):
            rgb, box = np.asarray(photograph), list(car["box"])
            for _ in range(turn):
                left, top, right, bottom = box
                box = [top, rgb.shape[1] - right, bottom, rgb.shape[1] - left]
                rgb = np.rot90(rgb)
            found.append(judge.View(*window(rgb, box, longest), car["view"]))
    return found


def window(rgb: Image8, box: list[float], longest: int) -> tuple[Image8, tuple[int, ...]]:
    """Return 640x480 pixels around a box scaled to `longest` pixels, mirrored outside, and it."""
    scale = longest / max(box[2] - box[0], box[3] - box[1])
    size = (round(rgb.shape[1] * scale), round(rgb.shape[0] * scale))
    filter_ = Image.Resampling.BOX if scale < 0.7 else Image.Resampling.BICUBIC
    scaled = np.asarray(Image.fromarray(np.ascontiguousarray(rgb)).resize(size, filter_))
    scaled = np.pad(scaled, ((240, 240), (320, 320), (0, 0)), "symmetric")
    left, top, right, bottom = (round(edge * scale) for edge in box)
    x, y = (left + right) // 2, (top + bottom) // 2
    shown = scaled[y : y + 480, x : x + 640]
    return shown, (left - x + 320, top - y + 240, right - x + 320, bottom - y + 240)


def shares(command: str, views: list[judge.View]) -> Figures:
    """Return how many of the views a detector calls a vehicle, with either threshold [%]."""
    named = judge.names_of(command, views)
    return {
        f"{name}, {least}": 100.0
        * sum(any(word in judge.VEHICLES and score >= least for word, score in of) for of in named)
        / max(len(views), 1)
        for name, least in (("any", judge.SCORE), ("sure", 0.3))
    }


def judged(asked: argparse.Namespace) -> dict[str, Figures]:
    """Return the answers of the detectors: a row for each kind of view."""
    kinds: dict[str, list[judge.View]] = {}
    for longest in (90, 45):
        if asked.real and (asked.real / "cars.json").is_file():
            marked = marked_cars(asked.real, longest)
            for name in ("steep", "oblique"):
                chosen = [view for view in marked if (view.name == "down") == (name == "steep")]
                kinds[f"photographs {name}, {longest} px"] = chosen
    for weather in asked.weathers:
        for height in asked.heights:
            kinds[f"{weather} {height} m"] = [
                view
                for name in asked.maps
                for view in judge.views_of(name, height, asked.views, asked.seed, "", weather)
            ]
        for longest in (90, 45):
            for name, pitch in PITCHES.items():
                kinds[f"{weather} {name}, {longest} px"] = [
                    view
                    for place in asked.maps
                    for view in judge.views_at(
                        place, pitch, longest, asked.views, asked.seed, weather
                    )
                ]
    rows: dict[str, Figures] = {}
    for name, views in kinds.items():
        rows[name] = {"n": float(len(views))}
        for number, command in enumerate(asked.detector, 1):
            found = shares(command, views)
            rows[name] |= {f"detector {number} {key}": value for key, value in found.items()}
        print(name, {key: round(value) for key, value in rows[name].items()}, flush=True)
    return rows


def table(rows: dict[str, Figures], before: dict[str, Figures]) -> str:
    """Return a table in Markdown; what a row was before stands in brackets."""
    names = list(dict.fromkeys(name for figures in rows.values() for name in figures))
    lines = ["| | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    for row, figures in rows.items():
        cells = []
        for name in names:
            cell = f"{figures[name]:.3g}" if name in figures else ""
            old = before.get(row, {}).get(name)
            cells.append(cell if old is None else f"{cell} ({old:.3g})")
        lines.append(f"| {row} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def sheet(rows: dict[str, list[Image8]], width: int = 320, most: int = 8) -> Image.Image:
    """Return the pictures of each row side by side, its name above."""
    height, label = 3 * width // 4, 16
    made = Image.new("RGB", (most * width, len(rows) * (height + label)), "white")
    pen = ImageDraw.Draw(made)
    for line, (name, pictures) in enumerate(rows.items()):
        pen.text((4, line * (height + label) + 2), name, fill="black")
        for column, rgb in enumerate(pictures[:: max(len(pictures) // most, 1)][:most]):
            small = Image.fromarray(rgb).resize((width, height), Image.Resampling.BOX)
            made.paste(small, (column * width, line * (height + label) + label))
    return made


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("build/looks"))
    parser.add_argument("--maps", nargs="+", default=list(judge.MAPS))
    parser.add_argument("--weathers", nargs="+", default=["day"])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=2, help="pictures of each kind a map")
    parser.add_argument("--real", type=Path, help="folder of photographs, see above")
    parser.add_argument("--detector", nargs="*", default=[], help="commands, see above")
    parser.add_argument("--views", type=int, default=6, help="views a map, for detectors")
    parser.add_argument("--heights", type=int, nargs="*", default=[6, 13, 22])
    parser.add_argument("--before", type=Path, help="looks.json of another build")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    rows: dict[str, Figures] = {}
    pictures: dict[str, list[Image8]] = {}
    if asked.real:
        rows["photographs"], pictures["photographs"] = photographs(asked.real)
    for weather in asked.weathers:
        for map_name in asked.maps:
            name = f"{map_name} {weather}"
            rows[name], pictures[name] = of_place(map_name, weather, asked.seed, asked.count)
            print(name, {key: round(value, 1) for key, value in rows[name].items()}, flush=True)
    sheet(pictures).save(asked.out / "looks.png")
    found: dict[str, Any] = {"build": this_build().world, "seed": asked.seed, "pictures": rows}
    if asked.detector:
        found["detectors"] = judged(asked)
    (asked.out / "looks.json").write_text(json.dumps(found, indent=1) + "\n")
    before = json.loads(asked.before.read_text()) if asked.before else {}
    page = [f"# Looks, seed {asked.seed}\n"]
    page += [
        table(found[kind], before.get(kind, {}))
        for kind in ("pictures", "detectors")
        if kind in found
    ]
    (asked.out / "looks.md").write_text("\n".join([*page, "![pictures](looks.png)\n"]))


if __name__ == "__main__":
    main()
