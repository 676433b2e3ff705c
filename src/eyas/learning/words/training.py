"""Trains the listener: blocks of new pictures, each shown a few times."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import TensorProto, helper
from torch import Tensor, nn
from torch.nn import functional

from eyas.benchmark.policies.listener.detector import BODIES, NAMES, STRIDE
from eyas.benchmark.policies.tracker.metadata import TRACKER
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.rng import stream
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.env import EnvConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.learning.checkpoint import RunFolder, Stateful, TrainingProgress
from eyas.learning.config import TrainConfig, WordsTraining
from eyas.learning.export import OnnxGraph, write_model
from eyas.learning.tracking.export import scaled_pixels
from eyas.learning.tracking.network import OFFSET
from eyas.learning.words.network import PARTS, PLAIN, ListenerNetwork
from eyas.learning.words.scenes import Scenes, Vehicles, chosen, drawn

# What the network of the listener is taught: where vehicles are, how they lie and look.

_ENOUGH: Final = 0.35  # Share of a vehicle that must be visible for it to count as seen
_WIDE: Final = 0.7  # Standard deviation of a peak [cells]

_JITTER: Final = 0.5
"""Standard deviation of the cell in which a vehicle's looks are taught, which is not always the
peak [cells]."""

_WEIGHTS: Final = (1.0, 0.5, 0.5, 0.5, 0.5)
"""Weights of peaks, places, headings, colours and bodies in the loss."""

_LIGHT, _TINT, _NOISE = 0.2, 0.04, 3.0
"""Largest changes of a picture's light and of each colour's, and noise [levels]."""


class Lesson(NamedTuple):
    """B pictures, and what is to be seen in them."""

    picture: Tensor  # Shape (B, 3, H, W)
    peaks: Tensor  # 1 in the middles of vehicles, and less around them, shape (B, C)
    weight: Tensor  # 0 where a vehicle is hidden for the most part, else 1, shape (B, C)
    vehicle: Tensor  # Picture and cell of V vehicles, shape (V, 2)
    cell: Tensor  # Where they are taught, shape (V,)
    place: Tensor  # Shape (V, 2), as all that follow as in `Vehicles`
    heading: Tensor
    colour: Tensor
    body: Tensor


class ListenerLoss(NamedTuple):
    """How wrong a network is."""

    total: Tensor
    found: float  # Share of the vehicles whose cells have odds above 1
    colour: float  # Share of the vehicles with a named colour whose most probable name is right
    body: float  # Share of the vehicles whose most probable body is right


def lesson(
    scenes: Scenes,
    rows: NDArray[np.int64],  # Which are chosen, shape (B,)
    grid: tuple[int, int],
    rng: np.random.Generator,
) -> Lesson:
    """Return some pictures, mirrored, lighter or darker."""
    vehicles = _chosen(scenes.vehicles, rows)
    picture, mirror = _changed(scenes.picture[rows].astype(np.float32), rng)
    size = np.array(picture.shape[:1:-1], np.float32)
    turned = mirror[vehicles.picture]
    place = np.where(turned, size - vehicles.place, vehicles.place)
    heading = np.where(turned, -vehicles.heading, vehicles.heading)
    seen = vehicles.share >= _ENOUGH
    peaks, hidden = (
        _around(place[mask], vehicles.picture[mask], len(rows), grid) for mask in (seen, ~seen)
    )
    weight = ((hidden < 0.3) | (peaks > 0.3)).astype(np.float32)
    moved = place + STRIDE * np.clip(_JITTER * rng.standard_normal(place.shape), -1.0, 1.0)
    column, row = (np.floor(moved[:, axis] / STRIDE).astype(np.int64) for axis in (0, 1))
    cell = np.clip(row, 0, grid[0] - 1) * grid[1] + np.clip(column, 0, grid[1] - 1)
    parts = (vehicles.picture, cell, place, heading, vehicles.colour, vehicles.body)
    taught = (torch.from_numpy(np.ascontiguousarray(part[seen])) for part in parts)
    return Lesson(*map(torch.from_numpy, (picture, peaks, weight)), *taught)


def _chosen(vehicles: Vehicles, rows: NDArray[np.int64]) -> Vehicles:
    """Return the vehicles of some pictures, which are numbered anew."""
    order = np.argsort(rows)
    at = np.searchsorted(rows[order], vehicles.picture)
    mine = rows[order][np.minimum(at, len(rows) - 1)] == vehicles.picture
    return chosen(vehicles, mine)._replace(picture=order[at[mine]])


def _changed(
    picture: NDArray[np.float32], rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return changed pictures and which are mirrored in columns and rows, shape (B, 2)."""
    count = len(picture)
    mirror = rng.random((count, 2)) < 0.5
    for row, (across, down) in enumerate(mirror.tolist()):
        if across:
            picture[row] = picture[row, ..., ::-1].copy()
        if down:
            picture[row] = picture[row, :, ::-1].copy()
    light = 1.0 + rng.uniform(-_LIGHT, _LIGHT, (count, 1, 1, 1))
    tint = 1.0 + rng.uniform(-_TINT, _TINT, (count, 3, 1, 1))
    noise = rng.standard_normal(picture.shape, np.float32)
    picture = picture * (light * tint).astype(np.float32) + np.float32(_NOISE) * noise
    return np.clip(picture, 0.0, 255.0), mirror


def _around(
    place: NDArray[np.float32], picture: NDArray[np.int64], count: int, grid: tuple[int, int]
) -> NDArray[np.float32]:
    """Return peaks at places, shape (count, C)."""
    peaks = np.zeros((count, *grid), np.float32)
    middle = place / STRIDE - 0.5
    nearest = np.round(middle).astype(np.int64)
    for down in (-2, -1, 0, 1, 2):
        for across in (-2, -1, 0, 1, 2):
            column, row = (nearest + np.array((across, down))).T
            away = np.square(np.stack((column, row), axis=1) - middle).sum(axis=1)
            if down == across == 0:
                away = np.zeros_like(away)
            inside = (column >= 0) & (row >= 0) & (column < grid[1]) & (row < grid[0])
            value = np.exp(-away / (2.0 * _WIDE * _WIDE)).astype(np.float32)
            where = picture[inside], row[inside], column[inside]
            np.maximum.at(peaks, where, value[inside])
    return peaks.reshape(count, -1)


def loss_of(network: ListenerNetwork, shown: Lesson) -> ListenerLoss:
    """Return how wrong a network is."""
    vehicle, places, headings, colours, bodies = network(shown.picture)
    at = shown.vehicle, shown.cell
    count = max(len(shown.cell), 1)
    angle = shown.heading
    double = torch.stack(
        (angle[:, 0] * angle[:, 0] - angle[:, 1] * angle[:, 1], 2.0 * angle[:, 0] * angle[:, 1]), 1
    )
    wanted = torch.cat((angle, double), 1)
    named = shown.colour >= 0
    losses = (
        _peak_loss(vehicle, shown),
        functional.smooth_l1_loss(places[at], shown.place, reduction="sum") / count,
        (headings[at] - wanted).square().sum() / count,
        functional.cross_entropy(colours[at][named], shown.colour[named]),
        functional.cross_entropy(bodies[at], shown.body),
    )
    total = sum(weight * loss for weight, loss in zip(_WEIGHTS, losses, strict=True))
    assert isinstance(total, Tensor)
    with torch.no_grad():
        found = (vehicle[at] > 0.0).float().mean().item()
        colour = (colours[at][named].argmax(1) == shown.colour[named]).float().mean().item()
        body = (bodies[at].argmax(1) == shown.body).float().mean().item()
    return ListenerLoss(total, found, colour, body)


def _peak_loss(vehicle: Tensor, shown: Lesson) -> Tensor:
    """Return the focal loss of "Objects as points", equation 1, for each vehicle."""
    chance = torch.sigmoid(vehicle)
    yes, no = functional.logsigmoid(vehicle), functional.logsigmoid(-vehicle)
    middle = (shown.peaks == 1.0).float()
    less = (1.0 - shown.peaks).square().square()
    gained = middle * (1.0 - chance).square() * yes
    gained = gained + (1.0 - middle) * less * chance.square() * no
    return -(gained * shown.weight).sum() / middle.sum().clamp(min=1.0)


# The network of the listener as an ONNX file, see `eyas.benchmark.policies.listener.detector`.


def export(network: ListenerNetwork, env: EnvConfig, settings: TrackerSettings, path: Path) -> None:
    """Write a network."""
    write_model(_graph(network), env, path, {TRACKER: settings.model_dump(mode="json")})


def _graph(network: ListenerNetwork) -> onnx.GraphProto:
    """Return what a network computes."""
    graph = OnnxGraph()
    cells, (height, width) = len(network.cells), network.size
    answers = graph.convolution("answers", _trunk(graph, network), network.head)
    turned = graph.node("Transpose", [answers], "answers.last", perm=[0, 2, 3, 1])
    shape = graph.weight("answers.shape", np.array([0, cells, sum(PARTS)]))
    rows = graph.node("Reshape", [turned, shape], "answers.rows")
    parts = ["vehicle", "offset", "headings", "colours", "bodies"]
    sizes = graph.weight("parts", np.array(PARTS))
    graph.nodes.append(helper.make_node("Split", [rows, sizes], parts, axis=2))
    flat = graph.weight("flat", np.array([0, cells]))
    graph.node("Reshape", ["vehicle", flat], "vehicles")
    scaled = graph.node("Mul", ["offset", graph.number("offset.scale", OFFSET)], "offset.pixels")
    graph.node("Add", [scaled, graph.weight("cells", network.cells[None])], "places")
    outputs = {"vehicles": [], "places": [2], "headings": [4]}
    outputs |= {"colours": [len(NAMES)], "bodies": [len(BODIES)]}
    return helper.make_graph(
        graph.nodes,
        "eyas",
        [helper.make_tensor_value_info("image", TensorProto.UINT8, ["n", 3, height, width])],
        [
            helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", cells, *rest])
            for name, rest in outputs.items()
        ],
        graph.weights,
    )


def _trunk(graph: OnnxGraph, network: ListenerNetwork) -> str:
    """Add the convolutions; return their last output."""
    value = scaled_pixels(graph)
    for number, layer in enumerate(network.layers):
        before, name = value, f"convolution.{number}"
        value = graph.convolution(name, value, _folded(layer, network.norms[number]))
        value = graph.node("Relu", [value], f"{name}.relu")
        if number >= PLAIN:
            value = graph.node("Add", [value, before], f"{name}.sum")
    return value


def _folded(layer: nn.Conv2d, norm: nn.Module) -> nn.Conv2d:
    """Return a convolution that does what one and the norm behind it do."""
    assert isinstance(norm, nn.BatchNorm2d)
    return torch.nn.utils.fuse_conv_bn_eval(layer.eval(), norm.eval())


LISTENER: Final = TrackerSettings(height=44.2, gain=0.3)
"""45 m above the road, and about 0.8 m less above the middles of vehicles."""

_PICTURES: Final = 32  # Batch size of a step of learning
_WARM_UP: Final = 200  # Steps in which the rate of learning rises, at most a quarter of all

Say = Callable[[str], None]


def train(config: EyasConfig, folder: Path, *, resume: bool = False, say: Say = print) -> Path:
    """Train a listener; return the path of the ONNX file.

    A run that is resumed goes on with the next block, and gives the same.

    Args:
        config: The settings: those of the preset `eyas-words`, with any seed and `train.words`.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    _refuse_unlike(config)
    files, training = RunFolder(folder), TrainConfig.of(config).words
    files.begin(config, resume=resume)
    torch.set_num_threads(1)
    torch.manual_seed(config.seed)
    seen = config.env.observation
    network = ListenerNetwork((seen.height, seen.width))
    network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    optimiser = torch.optim.AdamW(network.parameters(), training.learning_rate, weight_decay=1e-4)
    parts: dict[str, Stateful] = {"network": network, "optimiser": optimiser}
    progress = files.load(parts)
    begun = time.process_time()
    say(f"{training.blocks} blocks, {training.pictures:,} pictures in lessons")
    while progress.block < training.blocks:
        scenes = drawn(config.env, config.seed, progress.block, training.scenes)
        losses = list(_taught(network, optimiser, scenes, config, progress.block))
        _add_row(progress, losses, training)
        files.save(progress, parts)
        say(_line(progress, training) + f"  CPU {time.process_time() - begun:.0f} s")
    export(network, config.env, LISTENER, files.policy)
    return files.policy


def _taught(
    network: ListenerNetwork,
    optimiser: torch.optim.Optimizer,
    scenes: Scenes,
    config: EyasConfig,
    block: int,
) -> Iterator[ListenerLoss]:
    """Teach a block; yield how wrong the network is in each step in which pictures are new."""
    training = TrainConfig.of(config).words
    rng = stream(config.seed, "lessons of words", block)
    steps = training.passes * (training.scenes // _PICTURES)
    total, step = steps * training.blocks, steps * block
    network.train()
    for number in range(training.passes):
        order = rng.permutation(training.scenes)
        for first in range(0, training.scenes, _PICTURES):
            rows = order[first : first + _PICTURES]
            share = min(1.0, (step + 1) / min(_WARM_UP, max(total // 4, 1)))
            optimiser.param_groups[0]["lr"] = (
                training.learning_rate * share * (1.0 - 0.98 * step / total)
            )
            loss = loss_of(network, lesson(scenes, rows, network.grid, rng))
            optimiser.zero_grad()
            loss.total.backward()  # type: ignore[no-untyped-call]
            torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
            optimiser.step()
            step += 1
            if number == 0:
                yield loss


def _add_row(
    progress: TrainingProgress, losses: list[ListenerLoss], training: WordsTraining
) -> None:
    """Note a block in the curve."""
    progress.block += 1
    progress.decisions = progress.stage_decisions = progress.block * training.block_pictures
    means = np.mean(
        [(each.total.item(), each.found, each.colour, each.body) for each in losses], axis=0
    )
    loss, found, colour, body = (round(float(mean), 4) for mean in means)
    row = {"loss": loss, "found": found, "colour": colour, "body": body}
    progress.rows.append({"block": progress.block, "decisions": progress.decisions, **row})


def _line(progress: TrainingProgress, training: WordsTraining) -> str:
    row = progress.rows[-1]
    return (
        f"block {progress.block} of {training.blocks}: loss {row['loss']:.3f}, found "
        f"{row['found']:.3f}, colour {row['colour']:.3f}, body {row['body']:.3f}"
    )


def _refuse_unlike(config: EyasConfig) -> None:
    """Refuse settings that would change nothing."""
    wanted = load_settings(preset_file("eyas-words"))
    for name in sorted(EyasConfig.model_fields.keys() - {"mode", "seed", "train"}):
        if getattr(config, name) != getattr(wanted, name):
            raise ConfigError(
                f"{name}: not allowed here: a listener's pictures have both maps and all weathers; "
                "besides preset 'eyas-words' only seed and train.words can be chosen"
            )
    if TrainConfig.of(config).begin_from is not None:
        raise ConfigError("train.begin_from: not allowed for a listener: it begins anew")
