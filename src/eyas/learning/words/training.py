"""Trains the listener: blocks of new pictures, each shown a few times."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper
from torch import nn

from eyas.benchmark.policies.listener.detector import BODIES, NAMES
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
from eyas.learning.words.lessons import ListenerLoss, lesson, loss_of
from eyas.learning.words.network import PARTS, PLAIN, ListenerNetwork
from eyas.learning.words.scenes import Scenes, drawn

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
