"""Networks in ONNX files as people export them: other names, layouts, numbers, batches, actions."""

from types import SimpleNamespace

import numpy as np
import pytest

from eyas.benchmark.policies.foreign import ForeignPolicy, adapt
from eyas.benchmark.policies.onnx import OnnxPolicy, load_onnx
from eyas.engine.core.errors import EyasError

onnx = pytest.importorskip("onnx")
pytest.importorskip("onnxruntime")

FLOAT, HALF, BYTES, LONG = (
    getattr(onnx.TensorProto, name) for name in ("FLOAT", "FLOAT16", "UINT8", "INT64")
)


def network(path, shape, kind=FLOAT, outputs=7, name="obs", others=(), chosen=False):
    """Write a network whose outputs are all the mean of the first channel of its picture."""
    helper, make = onnx.helper, onnx.helper.make_node
    axis = 1 if shape[1] in (1, 3, 4, 12) else 3
    rest = [each for each in (1, 2, 3) if each != axis]
    nodes = [
        make("Cast", [name], ["number"], to=FLOAT),
        make("ReduceMean", ["number"], ["means"], axes=rest, keepdims=0),
        make("Slice", ["means", "zero", "one", "one"], ["first"]),
        make("Expand", ["first", "many"], ["spread"]),
        make("ArgMax", ["spread"], ["act"], axis=1, keepdims=0)
        if chosen
        else make("Cast", ["spread"], ["act"], to=HALF if kind == HALF else FLOAT),
    ]
    constants = {"zero": [0], "one": [1], "many": [1, outputs]}
    values = [
        helper.make_tensor(key, LONG, [len(value)], value) for key, value in constants.items()
    ]
    values[0] = helper.make_tensor("zero", LONG, [2], [0, 0])
    values[1] = helper.make_tensor("one", LONG, [2], [1 << 40, 1])
    nodes[2] = make("Slice", ["means", "zero", "one"], ["first"])
    batch = shape[0]
    answer = [batch] if chosen else [batch, outputs]
    graph = helper.make_graph(
        nodes,
        "net",
        [helper.make_tensor_value_info(name, kind, shape)]
        + [helper.make_tensor_value_info(each, FLOAT, ["n", 8]) for each in others],
        [helper.make_tensor_value_info("act", LONG if chosen else
                                       HALF if kind == HALF else FLOAT, answer)],
        values,
    )  # fmt: skip
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
    model.ir_version = 8
    onnx.save(model, str(path))
    return path


def flown(policy, count=3):
    """Return the answers to pictures whose red is 51, green 102, blue 153."""
    image = policy.env.observation
    colours = np.array([51, 102, 153], np.uint8)
    if str(image.colours) == "grey":
        pictures = np.full((count, image.height, image.width), 51, np.uint8)
        if image.frames > 1:
            pictures = np.repeat(pictures[:, None], image.frames, axis=1)
    else:
        pictures = np.tile(colours, image.frames) * np.ones(
            (count, image.height, image.width, 1), np.uint8
        )
        if str(image.layout) == "chw":
            pictures = pictures.transpose(0, 3, 1, 2)
    policy.begin(SimpleNamespace(seeds=np.arange(count), told=None))
    sight = SimpleNamespace(observation=pictures, deciding=np.ones(count, bool))
    return (
        policy.act(sight).action if hasattr(policy.act(sight), "action") else policy.act(sight)[0]
    )


@pytest.mark.parametrize(
    ("shape", "kind", "outputs", "mean"),
    [
        (["n", 3, 84, 84], FLOAT, 4, 0.2),
        (["n", 84, 84, 3], FLOAT, 4, 0.2),
        ([1, 3, 48, 64], FLOAT, 4, 0.2),
        ([2, 3, 48, 64], FLOAT, 4, 0.2),
        (["n", 3, "h", "w"], FLOAT, 4, 0.2),
        (["n", 3, 84, 84], BYTES, 4, 51.0),
        (["n", 3, 84, 84], HALF, 4, 0.2),
        (["n", 12, 84, 84], FLOAT, 4, 0.2),
        (["n", 1, 84, 84], FLOAT, 4, 0.2),
        (["n", 4, 84, 84], FLOAT, 4, 0.2),
        (["n", 3, 84, 84], FLOAT, 7, None),
    ],
)
def test_pictures_are_fed_as_the_shapes_say(tmp_path, shape, kind, outputs, mean):
    path = network(tmp_path / "a.onnx", shape, kind, outputs)
    policy = load_onnx(path, {}, sampled=False)
    assert isinstance(policy, ForeignPolicy)
    answer = flown(policy)
    assert len(answer) == 3
    if mean is None:
        assert policy.env.actions == "discrete"
        assert answer.tolist() == [0, 0, 0]  # all scores are equal: the first
    else:
        assert policy.env.actions == "shares"
        np.testing.assert_allclose(answer, mean, rtol=1e-3)


def test_whole_numbers_are_actions_already(tmp_path):
    path = network(tmp_path / "a.onnx", ["n", 3, 84, 84], chosen=True)
    policy = load_onnx(path, {}, sampled=False)
    assert flown(policy).tolist() == [0, 0, 0]
    assert "numbers of actions" in policy.assumed


@pytest.mark.parametrize(
    ("adapter", "mean"),
    [
        ({"scale": "bytes"}, 51.0),
        ({"scale": "signed"}, -0.6),
        ({"scale": "imagenet"}, (0.2 - 0.485) / 0.229),
        ({"swapped": True}, 0.6),
        ({"scale": "imagenet", "swapped": True}, (0.6 - 0.406) / 0.225),
    ],
)
def test_an_adapter_is_written_into_the_file(tmp_path, adapter, mean):
    path = network(tmp_path / "a.onnx", ["n", 3, 84, 84], outputs=4)
    said = adapt(path, tmp_path / "b.onnx", adapter, {"actions": "velocity", "action_repeat": 4})
    policy = load_onnx(tmp_path / "b.onnx", {}, sampled=False)
    assert said == policy.assumed
    assert (policy.env.actions, policy.env.action_repeat) == ("velocity", 4)
    np.testing.assert_allclose(flown(policy), mean, rtol=1e-5)
    onnx.checker.check_model(str(tmp_path / "b.onnx"))


@pytest.mark.parametrize(
    ("shape", "more", "line"),
    [
        (["n", 8], {}, "none has the shape of pictures"),
        (["n", 3, 84, 84], {"outputs": 2}, "the first is no action: 7 scores or 4 numbers"),
        (["n", 3, 84, 84], {"others": ["state"]}, "what the others are is not known"),
    ],
)
def test_what_is_no_policy_is_one_line(tmp_path, shape, more, line):
    path = tmp_path / "a.onnx"
    if len(shape) == 2:
        helper = onnx.helper
        graph = helper.make_graph(
            [helper.make_node("Identity", ["x"], ["y"])],
            "net",
            [helper.make_tensor_value_info("x", FLOAT, shape)],
            [helper.make_tensor_value_info("y", FLOAT, shape)],
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
        model.ir_version = 8
        onnx.save(model, str(path))
    else:
        network(path, shape, **more)
    with pytest.raises(EyasError) as caught:
        load_onnx(path, {}, sampled=False)
    assert line in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_network_of_ours_is_none_of_others(tmp_path):
    path = network(tmp_path / "a.onnx", ["n", 3, 84, 84], BYTES, name="image")
    assert isinstance(load_onnx(path, {}, sampled=False), OnnxPolicy)
    with pytest.raises(EyasError, match="'mean' is not allowed"):
        adapt(path, tmp_path / "b.onnx", {"scale": "mean"}, {})
    assert not (tmp_path / "b.onnx").exists()
