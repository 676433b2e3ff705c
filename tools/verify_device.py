"""Check that a graphics processor computes the bytes of processors, and measure how fast it is.

    python tools/verify_device.py            # on a machine with a card: some minutes
    python tools/verify_device.py --emulate --views 50 --maps village
    python tools/verify_device.py --ptx --views 2 --maps village

Please send us what it prints: the table in docs/gpu.md is made of it.

With `--emulate` the kernels of the card run on this processor, with several numbers of workers that
take turns in orders drawn by lot; that needs no card, and measures nothing. With `--ptx` a driver
that runs the card's own code on this processor stands for a card (`emulated_card`); that takes
seconds a picture, and a C compiler. `--write` makes `device_checksums.json` anew, after pictures
have changed on purpose.
"""

import argparse
import json
import math
import shutil
import statistics
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from emulated_card import emulated_card
from numpy.typing import NDArray

from eyas import EyasVectorEnv, __version__
from eyas.cli.bench.device import on_device, seconds_of
from eyas.cli.bench.pictures import PictureBatch
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.machine import describe_machine
from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sim.assets import load_assets
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.still import StillWorld
from eyas.engine.state.draw import Picture, Views
from eyas.engine.state.lighting import LightState
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.engine.state.terrain import reliefs
from eyas.engine.world.config import WorldConfig
from eyas.gpu.cuda import CudaError, cuda_device, gpu_line
from eyas.gpu.render.read_back import ReadBackRenderer
from eyas.lanes import exact
from eyas.lanes.device import Device, HostDevice

CHECKSUMS = Path(__file__).with_name("device_checksums.json")

MAPS = ("citystreet", "downtown", "village")
WEATHERS = ("day", "night", "snow", "rain", "foggy", "dust")
VIEWS = 20
"""Of each map and weather, each with 1, 2 and 4 samples: 1,080 pictures."""

HEIGHTS = (2.0, 9.0, 22.0, 60.0)
"""Of the cameras over the ground [m]; the lowest are among the vehicles."""

SIZE = (84, 84)
SAMPLES = (1, 2, 4)
COUNTS = (256, 1024, 4096, 16384)
STEPS = 200
INSTANT = 300.0
"""Time of the traffic [s]."""

_TENSORS = find_spec("torch") is not None

Checksums = dict[str, dict[str, list[int]]]
"""Of each map and weather, by the name of an output: one of each picture."""


def main() -> int:
    """Check and measure; return 1 if anything differs, 2 if there is no card."""
    asked = _arguments()
    if asked.ptx and shutil.which("cc") is None:
        print("verify_device: --ptx needs a C compiler, cc", file=sys.stderr)
        return 2
    if asked.ptx:
        with emulated_card(seed=1):
            return _checked(asked)
    return _checked(asked)


def _checked(asked: argparse.Namespace) -> int:
    conditions = [(m, w) for m in asked.maps.split(",") for w in asked.weathers.split(",")]
    if asked.write:
        return _write(conditions)
    if asked.emulate:
        workers = [(1, None), (3, 1), (7, 2), (64, 3)]
        chances = (None if seed is None else np.random.default_rng(seed) for _, seed in workers)
        devices: list[Device] = [
            HostDevice(count, chance) for (count, _), chance in zip(workers, chances, strict=True)
        ]
    else:
        try:
            devices = [cuda_device()]
        except CudaError as error:
            print(f"verify_device: no card: {error}; --emulate needs none", file=sys.stderr)
            return 2
    begun = time.perf_counter()
    print(f"Eyas {__version__}, build {this_build().id}, {describe_machine()}")
    emulated = asked.emulate or asked.ptx
    print("emulated on this processor" if emulated else gpu_line(), flush=True)
    wrong = _pictures(devices, conditions, asked.views)
    count, steps = (4, 10) if asked.ptx else (8, 40) if asked.emulate else (64, STEPS)
    wrong += _states("host" if asked.emulate else devices[0] if asked.ptx else "cuda", count, steps)
    if not emulated:
        _table(devices[0])
    print(f"{'EVERYTHING IS EQUAL' if wrong == 0 else f'DIFFERENT: {wrong}'}, ", end="")
    print(f"{time.perf_counter() - begun:.0f} s")
    return int(wrong > 0)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--emulate", action="store_true", help="needs no card")
    parser.add_argument("--ptx", action="store_true", help="needs no card, but a C compiler")
    parser.add_argument("--views", type=int, default=VIEWS, help="of each map and weather")
    parser.add_argument("--maps", default=",".join(MAPS))
    parser.add_argument("--weathers", default=",".join(WEATHERS))
    parser.add_argument("--write", action="store_true", help=f"make {CHECKSUMS.name}")
    return parser.parse_args()


def _pictures(devices: list[Device], conditions: list[tuple[str, str]], views: int) -> int:
    """Compare pictures on devices with those of this processor, and these with checksums."""
    document = json.loads(CHECKSUMS.read_text()) if CHECKSUMS.exists() else {}
    known: Checksums = document.get("checksums", {})
    wrong = count = 0
    for map_name, weather in conditions:
        name, begun = f"{map_name} {weather}", time.perf_counter()
        scene = _Scene(map_name, weather, views)
        near, bad = scene.drawn(scene.renderer), []
        told = known.get(name, {})
        for output, found in _sums(near).items():
            differ = sum(a != b for a, b in zip(found, told.get(output, ()), strict=False))
            words = f"{output} of this processor in {differ} of the checksums"
            bad += [f"{words}, which are of build {document['build']}"] * (differ > 0)
        for turn, device in enumerate(devices):
            far = scene.drawn(ReadBackRenderer(device, scene.renderer))
            for output, array in near.items():
                differ = _different(array, far[output])
                words = f"{output} in {differ} of {views} pictures"
                bad += [words + f" by device {turn}" * (len(devices) > 1)] * (differ > 0)
        count += len(SAMPLES) * views
        wrong += len(bad)
        checked = f"{min(views, len(told.get('colours', ())))} of {views} with checksums"
        said = "DIFFERENT: " + "; ".join(bad) if bad else "equal"
        print(f"{name}: {said} ({checked}, {time.perf_counter() - begun:.1f} s)", flush=True)
    print(f"{count} pictures; depth, objects, classes, normals, boxes and pixels of {views} "
          f"in each of {len(conditions)} conditions")  # fmt: skip
    return wrong


def _write(conditions: list[tuple[str, str]]) -> int:
    """Make the checksums, of as many views as are compared by default."""
    sums: Checksums = {}
    for map_name, weather in conditions:
        scene = _Scene(map_name, weather, VIEWS)
        sums[f"{map_name} {weather}"] = _sums(scene.drawn(scene.renderer))
        print(f"{map_name} {weather}", flush=True)
    rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(of)}" for name, of in sums.items())
    head = f' "eyas": "{__version__}",\n "build": "{this_build().id}",\n "checksums":'
    CHECKSUMS.write_text(f"{{\n{head} {{\n{rows}\n }}\n}}\n")
    return 0


class _Scene:
    """Cameras over the lanes of a map, in wind, while snow or rain falls.

    Args:
        map_name: The map.
        weather: The weather.
        count: Number of cameras; the first of more are the same.
    """

    def __init__(self, map_name: str, weather: str, count: int) -> None:
        config = SimConfig(world=WorldConfig(map=map_name, weather=weather))
        assets = load_assets(config.world, config.traffic, 1)
        assert isinstance(assets.renderer, CpuRenderer)
        self.renderer = assets.renderer
        still = StillWorld(assets)
        self._movers = still.movers(INSTANT)
        self._count, self._actors = count, assets.traffic.actors
        number = np.arange(count)
        turn = number * 2.399963229728653  # the golden angle spreads them evenly
        height = np.array(HEIGHTS)[number // 2 % len(HEIGHTS)]
        pitch = np.where(height < 5.0, 0.15, 0.5 + 0.2 * (number % 5))
        rotation = _rotations(turn, pitch)
        # One over a lane, the next as far behind an actor as it must be to see it.
        lanes = assets.scene.network.lane_points
        points = lanes[(number * 7919) % len(lanes)]
        actors = still.actors(INSTANT)
        present = np.flatnonzero(actors.present[0])
        actor = present[(number * 7919) % len(present)]
        ahead = rotation[:, :2, 0] * (height / -rotation[:, 2, 0])[:, None]
        odd = (number % 2 == 1)[:, None]
        place = np.where(odd, actors.position[0, actor, :2] - ahead, points)
        terrain = assets.scene.terrain
        ground = terrain.floor + reliefs(terrain, place)
        ones = np.ones(count, np.float32)
        light = assets.lighting
        self._views = Views(
            position=np.column_stack([place, ground + height]),
            rotation=rotation,
            world=np.zeros(count, np.int32),
            subject=(ACTOR_OBJECT + actor).astype(np.int32),
            field_of_view=1.2,
            light=LightState(ones, ones, ones * np.float32(light.fog_density), 4 * ones, 3 * ones),
            instant=(INSTANT + 0.37 * number).astype(np.float64),
        )

    def drawn(self, renderer: Any) -> dict[str, NDArray[Any]]:  # noqa: ANN401  # of either kind
        """Return all outputs by name."""
        found: dict[str, NDArray[Any]] = {}
        for samples in SAMPLES:
            picture = Picture.create(self._count, *SIZE)
            renderer.draw(self._views, self._movers, picture, samples)
            assert picture.rgb is not None  # wanted above
            found[f"rgb {samples}"] = picture.rgb
        # Boxes of all actors take a picture's time each, so a few pictures have them.
        kinds = {"rgb": False, "depth": True, "object_id": True, "class_id": True, "normal": True}
        for count, wanted in (
            (self._count, {**kinds, "subject": True}),
            (min(self._count, 4), {"rgb": False, "depth": True, "actors": self._actors}),
        ):
            picture = Picture.create(count, *SIZE, **wanted)
            renderer.draw(_first(self._views, count), self._movers, picture)
            for field in fields(picture):
                array = getattr(picture, field.name)
                if array is not None:
                    found.setdefault(field.name, array)
        return found


def _first(views: Views, count: int) -> Views:
    """Return the first of some views."""
    assert views.light is not None
    return replace(
        views,
        position=views.position[:count],
        rotation=views.rotation[:count],
        world=views.world[:count],
        subject=views.subject[:count],
        light=LightState(*(array[:count] for array in views.light)),
        instant=None if views.instant is None else views.instant[:count],
    )


def _rotations(yaw: NDArray[Any], pitch: NDArray[Any]) -> NDArray[np.float64]:
    """Return cameras without roll: columns forward, left, up, shape (V, 3, 3)."""
    rotation = np.zeros((len(yaw), 3, 3))
    for k, (y, p) in enumerate(zip(yaw.tolist(), pitch.tolist(), strict=True)):
        cy, sy = (float(f(math.fmod(y, math.tau))) for f in (exact.cos, exact.sin))
        cp, sp = float(exact.cos(p)), float(exact.sin(p))
        rotation[k] = [[cy * cp, -sy, cy * sp], [sy * cp, cy, sy * sp], [-sp, 0.0, cp]]
    return rotation


def _sums(outputs: dict[str, NDArray[Any]]) -> dict[str, list[int]]:
    """Return a checksum of each picture: of its colours, of its facts, of its actors' boxes."""
    sums: dict[str, list[int]] = {}
    for name, array in outputs.items():
        kind = "colours" if name.startswith("rgb") else name.partition("_")[0]
        kind = kind if kind in ("colours", "actor") else "facts"
        before = sums.get(kind, [0] * len(array))
        sums[kind] = [zlib.crc32(one.tobytes(), k) for one, k in zip(array, before, strict=True)]
    return sums


def _different(a: NDArray[Any], b: NDArray[Any]) -> int:
    """Return the number of pictures that differ in a byte."""
    return sum(one.tobytes() != other.tobytes() for one, other in zip(a, b, strict=True))


def _states(device: Device | str, count: int, steps: int) -> int:
    """Compare what environments give on a device, step by step, with those of this processor."""
    if device != "host" and not _TENSORS:
        print("environments: not compared: their tensors are PyTorch's, which is not here")
        return 0
    near, far = EyasVectorEnv(count), EyasVectorEnv(count, device=device)
    allowed: Any = near.single_action_space
    random, wrong = np.random.default_rng(1), 0
    first, second = near.reset(seed=3)[0], far.reset(seed=3)[0]
    wrong += not np.array_equal(_here(first), _here(second))
    for _ in range(steps):
        actions = random.integers(0, allowed.n, count)
        pairs = zip(near.step(actions)[:4], far.step(actions)[:4], strict=True)
        wrong += not all(np.array_equal(_here(a), _here(b)) for a, b in pairs)
    said = f"DIFFERENT in {wrong} steps" if wrong else "observations, rewards and ends equal"
    print(f"environments: {count}, {steps} steps: {said}", flush=True)
    return int(wrong > 0)


def _here(values: Any) -> NDArray[Any]:  # noqa: ANN401  # a tensor or an array
    return np.asarray(values.cpu().numpy() if hasattr(values, "cpu") else values)


def _table(device: Device) -> None:
    """Print how fast a card is."""
    watts = None
    print("\nviews of 84x84, citystreet | day /s | night /s | snow /s | 4 samples, day /s")
    for views in COUNTS:
        day = PictureBatch(views, *SIZE)
        kinds = day, replace(day, weather="night"), replace(day, weather="snow")
        rates = []
        for batch in (*kinds, replace(day, samples=4)):
            draw = partial(ReadBackRenderer.draw_uploaded, *on_device(device, batch))
            spent = statistics.median(seconds_of(device, draw, 0.5))
            rates.append(f"{views / spent:,.0f}")
            if batch == PictureBatch(4096, *SIZE):
                watts = _watts(draw, spent)
            del draw  # its memory is needed
        print(f"{views} | " + " | ".join(rates), flush=True)
    print(f"power while 4096 views are drawn: {watts or 'not readable'} W")
    print("environments | whole steps /s")
    for count in COUNTS if _TENSORS else ():
        print(f"{count} | {_steps(device, count):,.0f}", flush=True)


def _watts(draw: Callable[[], object], seconds: float) -> str | None:
    """Return what the card takes while it draws, if that can be read."""
    command = ["nvidia-smi", "--query-gpu=power.draw", "--format=csv,noheader,nounits"]
    for _ in range(int(2.0 / seconds)):  # it goes on with that when this has asked
        draw()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.split("\n", 1)[0].strip() or None


def _steps(device: Device, count: int) -> float:
    """Return how many steps environments on a card do in a second."""
    envs = EyasVectorEnv(count, device="cuda")
    envs.reset(seed=1)
    allowed: Any = envs.single_action_space
    actions = np.random.default_rng(1).integers(0, allowed.n, count)
    spent = []
    for _ in range(23):
        begun = time.perf_counter()
        envs.step(actions)
        device.synchronise()
        spent.append(time.perf_counter() - begun)
    return count / statistics.median(spent[3:])


if __name__ == "__main__":
    sys.exit(main())
