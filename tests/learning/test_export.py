"""An ONNX file gives what the network gives."""

import json

import numpy as np
import pytest

torch = pytest.importorskip("torch")
onnxruntime = pytest.importorskip("onnxruntime")

from eyas.engine.settings.env import EnvConfig, ObservationConfig
from eyas.learning.export import export
from eyas.learning.network import ACTIONS, HOVER, GoalCenteredNetwork, NetworkShape, TrackingNetwork


@pytest.mark.parametrize("memory", [False, True])
@pytest.mark.parametrize("size", [48, 84])
def test_onnx_gives_what_pytorch_gives(memory, size, tmp_path):
    shape = NetworkShape(channels=3, height=size, width=size, hidden=32, memory=memory)
    network = TrackingNetwork(shape)
    generator = torch.Generator().manual_seed(1)
    network.initialise(generator)
    torch.nn.init.normal_(network.policy.weight, generator=generator)
    seen = ObservationConfig(width=size, height=size, layout="chw")
    export(network, EnvConfig(observation=seen, action_repeat=4), tmp_path / "policy.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    told = json.loads(session.get_modelmeta().custom_metadata_map["eyas"])
    assert EnvConfig(**told) == EnvConfig(observation=seen, action_repeat=4)

    rng = np.random.default_rng(0)
    last, state = np.eye(ACTIONS, dtype=np.float32)[[HOVER] * 5], torch.zeros(5, shape.state)
    carried = {"memory": np.zeros((5, 32), np.float32)} if memory else {}
    for _ in range(4):
        picture = rng.integers(0, 256, (5, 3, size, size), np.uint8)
        with torch.no_grad():
            logits, _, after = network(torch.from_numpy(picture), state)
        got = session.run(None, {"image": picture, "last_action": last, **carried})
        # The file has weights of float16.
        assert np.allclose(got[0], logits.numpy(), atol=2e-2)
        action = logits.argmax(1)
        state = network.next_state(action, after)
        last = np.eye(ACTIONS, dtype=np.float32)[action.numpy()]
        carried = {"memory": got[1]} if memory else {}
        if memory:
            assert np.allclose(got[1], after.numpy(), atol=2e-3)


def test_the_actor_of_gc_vat_is_that_of_pytorch(tmp_path):
    shape = NetworkShape(3, 84, 84, hidden=32, memory=True, kind="gc-vat")
    network = GoalCenteredNetwork(shape)
    generator = torch.Generator().manual_seed(1)
    network.initialise(generator)
    torch.nn.init.normal_(network.actor.out.weight, generator=generator)
    seen = ObservationConfig(layout="chw")
    export(network, EnvConfig(observation=seen), tmp_path / "policy.onnx")
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    rng = np.random.default_rng(0)
    state, memory = torch.zeros(5, shape.state), np.zeros((5, 32), np.float32)
    for _ in range(4):
        picture = rng.integers(0, 256, (5, 3, 84, 84), np.uint8)
        with torch.no_grad():
            logits, value, after = network(torch.from_numpy(picture), state)
        assert (logits.shape, value.shape, after.shape) == ((5, ACTIONS), (5,), (5, 64))
        got = session.run(None, {"image": picture, "memory": memory})
        assert np.allclose(got[0], logits.numpy(), atol=2e-2)
        assert np.allclose(got[1], after[:, :32].numpy(), atol=2e-3)  # the actor's own
        state, memory = network.next_state(logits.argmax(1), after), got[1]
