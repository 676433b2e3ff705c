"""Networks as ONNX files, for onnxruntime and `eyas evaluate`."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper
from torch import Tensor, nn

from eyas.benchmark.policies.tracker.metadata import METADATA
from eyas.engine.core.files import write_atomic
from eyas.engine.core.installed import installed_version
from eyas.engine.settings.env import EnvConfig
from eyas.learning.network import (
    ACTIONS,
    HOVER,
    STRIDE,
    AnyNetwork,
    GoalCenteredNetwork,
    TrackingNetwork,
)

_OPSET = 17
_HALVED = 1024
"""Numbers from which on a tensor is stored as float16, which halves files; runtimes compute with
float32."""


class OnnxGraph:
    """Nodes and weights of a graph that is being written."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.weights: list[onnx.TensorProto] = []

    def weight(self, name: str, values: Any) -> str:  # noqa: ANN401  # whatever numpy takes
        """Add a tensor, an array or a number; return its name."""
        array = values.detach().cpu().numpy() if isinstance(values, Tensor) else np.asarray(values)
        if array.dtype == np.float32 and array.size >= _HALVED:
            half = f"{name}.half"
            self.weights.append(numpy_helper.from_array(array.astype(np.float16), half))
            return self.node("Cast", [half], name, to=TensorProto.FLOAT)
        self.weights.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
        return name

    def node(self, kind: str, inputs: list[str], output: str, **attributes: object) -> str:
        """Add a node with one output; return the output's name."""
        self.nodes.append(helper.make_node(kind, inputs, [output], **attributes))
        return output

    def linear(self, name: str, source: str, weight: Tensor, bias: Tensor) -> str:
        """Add a layer of sums."""
        parts = [source, self.weight(f"{name}.w", weight), self.weight(f"{name}.b", bias)]
        return self.node("Gemm", parts, name, transB=1)

    def number(self, name: str, value: float) -> str:
        """Add a number; return its name."""
        return self.weight(name, np.float32(value))

    def convolution(self, name: str, source: str, layer: nn.Conv2d) -> str:
        """Add a convolution."""
        parts = [
            source,
            self.weight(f"{name}.w", layer.weight),
            self.weight(f"{name}.b", layer.bias),
        ]
        padding = [int(side) for side in layer.padding]
        return self.node(
            "Conv",
            parts,
            name,
            strides=list(layer.stride),
            pads=[*padding, *padding],
            dilations=list(layer.dilation),
        )


def export(network: AnyNetwork, env: EnvConfig, path: Path) -> None:
    """Write a network.

    Inputs: `image`, uint8 (N, C, H, W); `last_action`, float (N, 7), a 1 at the last action, hover
    at the start; `memory`, float (N, hidden), if it has one, 0 at the start. Outputs: `logits`,
    float (N, 7), and `next_memory`. The metadata `eyas` has the settings of actions and
    observations as JSON.
    """
    graph, shape = OnnxGraph(), network.shape
    picture = ["n", shape.channels, shape.height, shape.width]
    inputs = [
        helper.make_tensor_value_info("image", TensorProto.UINT8, picture),
        helper.make_tensor_value_info("last_action", TensorProto.FLOAT, ["n", ACTIONS]),
    ]
    outputs = [helper.make_tensor_value_info("logits", TensorProto.FLOAT, ["n", ACTIONS])]
    if shape.memory:
        memory = ["n", shape.hidden]
        inputs.append(helper.make_tensor_value_info("memory", TensorProto.FLOAT, memory))
        outputs.append(helper.make_tensor_value_info("next_memory", TensorProto.FLOAT, memory))
    if isinstance(network, GoalCenteredNetwork):
        inputs = [one for one in inputs if one.name != "last_action"]
        _actor(graph, network)
    else:
        features = _features(graph, network)
        if network.memory is not None:
            features = _memory(graph, network.memory, features)
        graph.linear("logits", features, network.policy.weight, network.policy.bias)
    body = helper.make_graph(graph.nodes, "eyas", inputs, outputs, graph.weights)
    write_model(body, env, path)


def write_model(
    body: onnx.GraphProto, env: EnvConfig, path: Path, further: Mapping[str, Any] | None = None
) -> None:
    """Write what a network computes as an ONNX file."""
    model = helper.make_model(
        body,
        opset_imports=[helper.make_opsetid("", _OPSET)],
        ir_version=8,
        producer_name="eyas",
        producer_version=installed_version(),
    )
    said = env.model_dump(mode="json", include={"actions", "action_repeat", "observation"})
    metadata = {METADATA: said, **(further or {})}
    helper.set_model_props(model, {key: json.dumps(value) for key, value in metadata.items()})
    onnx.checker.check_model(model, full_check=True)
    write_atomic(path, model.SerializeToString())


def _features(graph: OnnxGraph, network: TrackingNetwork) -> str:
    """Add the convolutions and the layer behind them."""
    value = graph.node("Cast", ["image"], "image.float", to=TensorProto.FLOAT)
    later = [(layer.weight, layer.bias) for layer in (network.second, network.third)]
    for number, (weight, bias) in enumerate([network.first_convolution(), *later]):
        name = f"convolution.{number}"
        parts = [value, graph.weight(f"{name}.w", weight), graph.weight(f"{name}.b", bias)]
        value = graph.node("Conv", parts, name, strides=[STRIDE, STRIDE])
        value = graph.node("Relu", [value], f"{name}.relu")
    value = graph.node("Flatten", [value], "seen")
    # Hover is told as zeros.
    ends = [graph.weight(f"cut.{end}", np.array([at])) for end, at in (("0", 0), ("1", HOVER))]
    action = graph.node(
        "Slice", ["last_action", *ends, graph.weight("cut.axis", np.array([1]))], "told"
    )
    value = graph.node("Concat", [value, action], "seen.told", axis=1)
    value = graph.linear("layer", value, network.layer.weight, network.layer.bias)
    return graph.node("Relu", [value], "features")


def _actor(graph: OnnxGraph, network: GoalCenteredNetwork) -> None:
    """Add the actor of GC-VAT."""
    actor = network.actor
    value = graph.node("Cast", ["image"], "image.float", to=TensorProto.FLOAT)
    scale = graph.weight("scale", np.array([1.0 / 255.0], np.float32))
    value = graph.node("Mul", [value, scale], "pixels")
    for name, seeing in (("first", actor.first), ("second", actor.second)):
        value = graph.node("Relu", [graph.convolution(name, value, seeing)], f"{name}.relu")
    value = graph.node("Flatten", [value], "seen")
    value = graph.linear("layer", value, actor.layer.weight, actor.layer.bias)
    value = _memory(graph, actor.memory, graph.node("Relu", [value], "features"))
    for name, layer in (("wide", actor.wide), ("narrow", actor.narrow)):
        value = graph.linear(name, value, layer.weight, layer.bias)
        value = graph.node("Relu", [value], f"{name}.relu")
    graph.linear("logits", value, actor.out.weight, actor.out.bias)


def _memory(graph: OnnxGraph, cell: nn.GRUCell, features: str) -> str:
    """Add a step of a gated recurrent unit, as in `torch.nn.GRUCell`."""
    given = graph.linear("given", features, cell.weight_ih, cell.bias_ih)
    kept = graph.linear("kept", "memory", cell.weight_hh, cell.bias_hh)
    names = [f"{kind}.{gate}" for kind in ("given", "kept") for gate in ("reset", "update", "new")]
    graph.nodes.append(helper.make_node("Split", [given], names[:3], axis=1))
    graph.nodes.append(helper.make_node("Split", [kept], names[3:], axis=1))
    for gate in ("reset", "update"):
        graph.node("Add", [f"given.{gate}", f"kept.{gate}"], f"{gate}.sum")
        graph.node("Sigmoid", [f"{gate}.sum"], gate)
    graph.node("Mul", ["reset", "kept.new"], "new.kept")
    graph.node("Add", ["given.new", "new.kept"], "new.sum")
    graph.node("Tanh", ["new.sum"], "new")
    graph.node("Sub", ["memory", "new"], "change")
    graph.node("Mul", ["update", "change"], "remembered")
    return graph.node("Add", ["new", "remembered"], "next_memory")
