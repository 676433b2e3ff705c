"""The network of the tracker as an ONNX file, see `eyas.benchmark.policies.tracker.detector`."""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper

from eyas.benchmark.policies.tracker.course import HORIZONS, PAST
from eyas.benchmark.policies.tracker.detector import STRIDE
from eyas.benchmark.policies.tracker.metadata import TRACKER
from eyas.benchmark.policies.tracker.settings import TrackerSettings
from eyas.engine.settings.env import EnvConfig
from eyas.learning.export import OnnxGraph, write_model
from eyas.learning.tracking.driving import FARTHEST, Forecast
from eyas.learning.tracking.network import (
    CELL,
    MEAN,
    OFFSET,
    PATCH,
    SPREAD,
    SURE,
    UNSURE,
    DetectorNetwork,
)


def export(
    network: DetectorNetwork,
    forecast: Forecast,
    env: EnvConfig,
    settings: TrackerSettings,
    path: Path,
) -> None:
    """Write networks."""
    graph = OnnxGraph()
    cells, keys, (height, width) = len(network.cells), network.keys, network.size
    features = _trunk(graph, network)
    answers = graph.convolution("answers", features, network.head)
    rows = [
        _by_cell(graph, value, (cells, n))
        for value, n in ((features, network.width), (answers, 4 + keys))
    ]
    parts = ["objectness", "offset", "sureness", "keys.seen"]
    sizes = graph.weight("parts", np.array([1, 2, 1, keys]))
    graph.nodes.append(helper.make_node("Split", [rows[1], sizes], parts, axis=2))
    _keys(graph, network)
    _places(graph, network)
    _scores(graph, network, rows[0])
    _ahead(graph, forecast)
    inputs: dict[str, list[str | int]] = {
        "image": ["n", 3, height, width],
        "expected": ["n", 2],
        "spread": ["n", 1],
    }
    inputs |= {"key": ["n", keys], "known": ["n", 1], "past": ["n", PAST]}
    outputs: dict[str, list[str | int]] = {
        "scores": ["n", cells + 1],
        "places": ["n", cells, 3],
        "keys": ["n", cells, keys],
        "ahead": ["n", len(HORIZONS), 3],
    }
    body = helper.make_graph(
        graph.nodes,
        "eyas",
        [_value(name, shape) for name, shape in inputs.items()],
        [_value(name, shape) for name, shape in outputs.items()],
        graph.weights,
    )
    write_model(body, env, path, {TRACKER: settings.model_dump(mode="json")})


def _value(name: str, shape: list[str | int]) -> onnx.ValueInfoProto:
    kind = TensorProto.UINT8 if name == "image" else TensorProto.FLOAT
    return helper.make_tensor_value_info(name, kind, shape)


def _trunk(graph: OnnxGraph, network: DetectorNetwork) -> str:
    """Add the convolutions; return their last output."""
    value = scaled_pixels(graph)
    layers = network.first, network.second, network.third, network.fourth
    for number, layer in enumerate(layers):
        before = value
        value = graph.convolution(f"convolution.{number}", value, layer)
        value = graph.node("Relu", [value], f"convolution.{number}.relu")
    return graph.node("Add", [before, value], "features")


def scaled_pixels(graph: OnnxGraph) -> str:
    """Add what makes numbers of about 1 of the input `image`."""
    value = graph.node("Cast", ["image"], "image.float", to=TensorProto.FLOAT)
    value = graph.node("Sub", [value, graph.number("mean", MEAN)], "image.centred")
    return graph.node("Div", [value, graph.number("spread.of.pixels", SPREAD)], "image.scaled")


def _by_cell(graph: OnnxGraph, source: str, shape: tuple[int, int]) -> str:
    """Add the change from (N, K, H, W) to (N, cells, K)."""
    turned = graph.node("Transpose", [source], f"{source}.last", perm=[0, 2, 3, 1])
    return graph.node(
        "Reshape",
        [turned, graph.weight(f"{source}.shape", np.array([0, *shape]))],
        f"{source}.rows",
    )


def _keys(graph: OnnxGraph, network: DetectorNetwork) -> None:
    """Add the output `keys`."""
    side = (PATCH - STRIDE) // 2
    around = graph.node(
        "AveragePool",
        ["image.scaled"],
        "around",
        kernel_shape=[PATCH, PATCH],
        strides=[STRIDE, STRIDE],
        pads=[side] * 4,
        count_include_pad=1,
    )
    colour = graph.convolution("colour", around, network.colour)
    colours = _by_cell(graph, colour, (len(network.cells), network.keys))
    graph.node("Add", ["keys.seen", colours], "keys")


def _places(graph: OnnxGraph, network: DetectorNetwork) -> None:
    """Add the output `places`."""
    cells = graph.weight("cells", network.cells[None])
    scaled = graph.node("Mul", ["offset", graph.number("offset.scale", OFFSET)], "offset.pixels")
    where = graph.node("Add", [scaled, cells], "where")
    limits = [graph.number("sure", SURE), graph.number("unsure", UNSURE)]
    sureness = graph.node("Clip", ["sureness", *limits], "sureness.limited")
    graph.node("Concat", [where, sureness], "places", axis=2)


def _scores(graph: OnnxGraph, network: DetectorNetwork, features: str) -> None:
    """Add the output `scores`."""
    cells = len(network.cells)
    worth, loss = network.alike.detach()
    row = graph.node("Unsqueeze", ["key", graph.weight("middle", np.array([1]))], "key.row")
    apart = graph.node("Sub", ["keys", row], "keys.apart")
    apart = graph.node("Mul", [apart, apart], "keys.apart.square")
    axis = graph.weight("last", np.array([2]))
    apart = graph.node("ReduceSum", [apart, axis], "keys.distance", keepdims=1)
    lost = graph.node("Mul", [apart, graph.number("alike.loss", float(loss.exp()))], "alike.lost")
    alike = graph.node("Sub", [graph.number("alike.worth", float(worth)), lost], "alike.known")
    known = graph.node("Unsqueeze", ["known", axis], "known.column")
    alike = graph.node("Mul", [alike, known], "alike")
    looks = graph.node("Add", ["objectness", alike], "looks")
    flat = graph.weight("flat", np.array([0, cells]))
    looks = graph.node("Reshape", [looks, flat], "looks.flat")
    prior = _prior(graph)
    share = graph.node("Softmax", [prior], "share", axis=1)
    share = graph.node("Unsqueeze", [share, "middle"], "share.row")
    near = graph.node("MatMul", [share, features], "near.row")
    wide = graph.weight("near.shape", np.array([0, network.width]))
    near = graph.node("Reshape", [near, wide], "near")
    inside = graph.node("ReduceLogSumExp", [prior], "inside", axes=[1], keepdims=1)
    parts = [near, graph.node("Log", ["spread"], "spread.log"), "known", inside]
    value = graph.node("Concat", parts, "unseen.seen", axis=1)
    first, last = network.unseen_first, network.unseen_last
    value = graph.linear("unseen.first", value, first.weight, first.bias)
    value = graph.node("Relu", [value], "unseen.relu")
    unseen = graph.linear("unseen", value, last.weight, last.bias)
    seen = graph.node("Add", [looks, prior], "seen")
    graph.node("Concat", [seen, unseen], "scores", axis=1)


def _ahead(graph: OnnxGraph, forecast: Forecast) -> None:
    """Add the output `ahead`."""
    value = graph.node("Sub", ["past", graph.weight("past.mean", forecast.mean)], "past.centred")
    value = graph.node("Div", [value, graph.weight("past.spread", forecast.spread)], "past.scaled")
    limits = [graph.number("past.least", -FARTHEST), graph.number("past.most", FARTHEST)]
    value = graph.node("Clip", [value, *limits], "past.limited")
    for name, layer in (("first", forecast.first), ("second", forecast.second)):
        value = graph.linear(f"ahead.{name}", value, layer.weight, layer.bias)
        value = graph.node("Relu", [value], f"ahead.{name}.relu")
    value = graph.linear("ahead.last", value, forecast.last.weight, forecast.last.bias)
    shape = graph.weight("ahead.shape", np.array([0, len(HORIZONS), 3]))
    value = graph.node("Reshape", [value, shape], "ahead.rows")
    value = graph.node("Mul", [value, graph.weight("ahead.unit", forecast.unit)], "ahead.scaled")
    graph.node("Add", [value, graph.weight("ahead.least", forecast.least)], "ahead")


def _prior(graph: OnnxGraph) -> str:
    """Add the logarithm of the probability that the target is in each cell, shape (N, C)."""
    square = graph.node("Mul", ["spread", "spread"], "spread.square")
    variance = graph.node("Add", [square, graph.number("cell", CELL)], "variance")
    expected = graph.node(
        "Unsqueeze", ["expected", graph.weight("second", np.array([1]))], "expected.row"
    )
    away = graph.node("Sub", ["cells", expected], "away")
    away = graph.node("Mul", [away, away], "away.square")
    away = graph.node(
        "ReduceSum", [away, graph.weight("axis", np.array([2]))], "away.sum", keepdims=0
    )
    double = graph.node("Add", [variance, variance], "variance.double")
    far = graph.node("Div", [away, double], "away.relative")
    wide = graph.node("Log", [variance], "variance.log")
    minus = graph.node("Add", [far, wide], "prior.minus")
    return graph.node("Neg", [minus], "prior")
