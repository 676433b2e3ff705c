"""The network of the listener as an ONNX file, see `eyas.benchmark.policies.listener.detector`."""

from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper
from torch import nn

from eyas.benchmark.policies.listener.detector import BODIES, NAMES
from eyas.benchmark.policies.tracker.metadata import TRACKER
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.engine.settings.env import EnvConfig
from eyas.learning.export import Graph, write_model
from eyas.learning.tracking.export import scaled_pixels
from eyas.learning.tracking.network import OFFSET
from eyas.learning.words.network import PARTS, PLAIN, ListenerNetwork


def export(network: ListenerNetwork, env: EnvConfig, settings: TrackerSettings, path: Path) -> None:
    """Write a network."""
    write_model(_graph(network), env, path, {TRACKER: settings.model_dump(mode="json")})


def _graph(network: ListenerNetwork) -> onnx.GraphProto:
    """Return what a network computes."""
    graph = Graph()
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


def _trunk(graph: Graph, network: ListenerNetwork) -> str:
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
