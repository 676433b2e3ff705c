"""Policies in files: ONNX, PyTorch, stable-baselines3."""

import json

import gymnasium
import numpy as np
import pytest

from eyas.benchmark.plan.plan import EvaluationPlan, check
from eyas.engine.core.errors import EyasError

IMAGE = {"width": 16, "height": 12, "layout": "chw"}
SETTINGS = {"observation": IMAGE, "actions": "discrete", "action_repeat": 25}


@pytest.fixture(scope="module")
def onnx():
    pytest.importorskip("onnxruntime")
    return pytest.importorskip("onnx")


def network(onnx, path, *, memory, settings=SETTINGS):
    """Save a network: it hovers at first; with memory, it flies forward from its third look on.

    Without, it hovers if it hovered before, which it is told to have done at the start.
    """
    helper, kind = onnx.helper, onnx.TensorProto
    image = helper.make_tensor_value_info("image", kind.UINT8, ["n", 3, 12, 16])
    logits = helper.make_tensor_value_info("logits", kind.FLOAT, ["n", 7])
    if memory:
        state = helper.make_tensor_value_info("looks", kind.FLOAT, ["n", 1])
        after = helper.make_tensor_value_info("next_looks", kind.FLOAT, ["n", 1])
        # Score of forward is looks - 1.5, of hover 0, of the others -9.
        weights = np.array([[1, 0, 0, 0, 0, 0, 0]], np.float32)
        biases = np.array([-1.5, -9, -9, -9, -9, -9, 0], np.float32)
        nodes = [
            helper.make_node("Gemm", ["looks", "weights", "biases"], ["logits"]),
            helper.make_node("Add", ["looks", "one"], ["next_looks"]),
        ]
        constants = {"weights": weights, "biases": biases, "one": np.ones((1, 1), np.float32)}
        inputs, outputs = [image, state], [logits, after]
    else:
        last = helper.make_tensor_value_info("last_action", kind.FLOAT, ["n", 7])
        nodes, constants = [helper.make_node("Identity", ["last_action"], ["logits"])], {}
        inputs, outputs = [image, last], [logits]
    stored = [onnx.numpy_helper.from_array(value, name) for name, value in constants.items()]
    graph = helper.make_graph(nodes, "policy", inputs, outputs, stored)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(model, {"eyas": json.dumps(settings)})
    onnx.save(model, path)
    return str(path)


def test_a_network_that_repeats_its_last_action_hovers(onnx, fly, tmp_path):
    path = network(onnx, tmp_path / "still.onnx", memory=False)
    assert fly(path) == fly("hover")


def test_memory_is_kept_for_each_episode_and_changes_with_its_own_looks_only(onnx, fly, tmp_path):
    path = network(onnx, tmp_path / "forward.onnx", memory=True)
    records = fly(path)
    assert records != fly("hover")
    assert fly(path, batch=1) == records
    # Drawn latencies let the episodes of a batch look at different times.
    times = tmp_path / "times.txt"
    times.write_text("0\n300\n")
    assert fly(path, latency=str(times), batch=1) == fly(path, latency=str(times))


def test_drawn_actions_come_from_the_episodes_seeds(onnx, fly, tmp_path):
    path = network(onnx, tmp_path / "still.onnx", memory=False)
    drawn = fly(path, sampled=True)
    assert drawn == fly(path, sampled=True, batch=1)
    assert drawn != fly(path)


def test_what_is_no_policy_is_one_line(onnx, tmp_path):
    (tmp_path / "text.onnx").write_text("no network")
    with pytest.raises(EyasError, match="not a network in ONNX"):
        check(EvaluationPlan(policy=str(tmp_path / "text.onnx")))
    path = network(onnx, tmp_path / "x.onnx", memory=False, settings={"action_repat": 4})
    with pytest.raises(EyasError, match="did you mean 'action_repeat'"):
        check(EvaluationPlan(policy=path))


@pytest.mark.parametrize(
    "said", ["[]", "1", "null", '"text"', "[" * 100_000, '{"observation": 5}', '{"env": {}}', "{"]
)
def test_metadata_that_is_no_table_of_settings_is_one_line(onnx, tmp_path, said):
    path = network(onnx, tmp_path / "x.onnx", memory=False)
    model = onnx.load(path)
    model.metadata_props[0].value = said
    onnx.save(model, path)
    with pytest.raises(EyasError, match="metadata 'eyas': ") as caught:
        check(EvaluationPlan(policy=path))
    assert "\n" not in str(caught.value)
    assert path in str(caught.value)


def test_a_file_does_not_ask_for_pictures_that_take_minutes_unless_the_user_does(onnx, tmp_path):
    large = {"observation": {"width": 4096, "height": 4096}}
    path = network(onnx, tmp_path / "x.onnx", memory=False, settings=large)
    with pytest.raises(EyasError, match=r"1 x 4096 x 4096 pixels; allowed: up to 4194304, unless"):
        check(EvaluationPlan(policy=path))
    check(EvaluationPlan(policy=path, env={"observation": {"width": 16, "height": 12}}))


@pytest.mark.slow
def test_a_module_of_torch_flies(fly, tmp_path):
    torch = pytest.importorskip("torch")
    from own_policies import hovering_module

    module = hovering_module(torch)
    torch.save(module, tmp_path / "still.pt")
    hover = fly("hover")
    # Its class was made in this process, and no other finds it.
    assert fly(str(tmp_path / "still.pt"), in_process=True) == hover
    example = torch.zeros(2, 3, 12, 16, dtype=torch.uint8)
    batch = torch.export.Dim("batch", min=1, max=4096)
    program = torch.export.export(module, (example,), dynamic_shapes=({0: batch},))
    extra = {"eyas.json": json.dumps(SETTINGS)}
    torch.export.save(program, str(tmp_path / "still.pt2"), extra_files=extra)
    assert fly(str(tmp_path / "still.pt2")) == hover
    torch.save({"weights": 1}, tmp_path / "dict.pt")
    with pytest.raises(EyasError, match="holds a dict, not a whole module"):
        check(EvaluationPlan(policy=str(tmp_path / "dict.pt")))


@pytest.mark.slow
def test_a_model_of_stable_baselines3_flies(fly, tmp_path):
    library = pytest.importorskip("stable_baselines3")
    from eyas.engine.envs.tracking_env import TrackingEnv

    env = TrackingEnv("dat-eval", observation={"width": 36, "height": 36, "layout": "chw"})
    model = library.PPO("CnnPolicy", env, n_steps=8, batch_size=8, device="cpu", seed=1)
    path = tmp_path / "model.zip"
    model.save(path)
    records = fly(str(path), env={"action_repeat": 25})
    assert [record.error for record in records] == [None] * 4
    assert fly(str(path), env={"action_repeat": 25}) == records


@pytest.mark.slow
def test_what_a_model_was_trained_with_travels_with_it(tmp_path, caplog):
    library = pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.vec_env import DummyVecEnv, VecFrameStack

    from eyas.benchmark.policies.sb3 import Sb3Policy
    from eyas.engine.envs.sb3 import EyasVecEnv
    from eyas.engine.envs.tracking_env import TrackingEnv

    seen = {"width": 40, "height": 36, "colours": "grey", "frames": 3, "layout": "chw"}
    config = {
        "env": {"action_repeat": 4, "observation": seen, "speeds": {"forward_speed": 9.0}},
        "start": {"height": 30.0},
        "control": {"frequency": 62.5},
    }
    plain = {**config, "env": {"action_repeat": 5, "actions": "velocity"}}
    for env, repeat, actions in (
        (EyasVecEnv(2, config), 4, "discrete"),
        (DummyVecEnv([lambda: TrackingEnv(config)]), 4, "discrete"),
        (VecFrameStack(EyasVecEnv(2, plain), 2), 5, "velocity"),
    ):
        model = library.PPO("CnnPolicy", env, n_steps=8, batch_size=8, device="cpu", seed=1)
        model.save(tmp_path / "model.zip")
        policy = Sb3Policy(tmp_path / "model.zip", {}, sampled=False)
        assert (policy.env.action_repeat, policy.env.actions) == (repeat, actions)
        if repeat == 4:
            assert policy.env == TrackingEnv(config).config.env
        else:
            assert policy.env.observation.frames == 2
        assert "start.height" not in caplog.text  # where flights begin is the protocol's matter
        assert "control.frequency=62.5" in caplog.text
        changed = Sb3Policy(tmp_path / "model.zip", {"action_repeat": 2}, sampled=False)
        assert changed.env.action_repeat == 2


@pytest.mark.slow
def test_a_model_that_does_not_say_how_it_was_trained_is_said(tmp_path, caplog):
    library = pytest.importorskip("stable_baselines3")
    from eyas.benchmark.policies.sb3 import Sb3Policy

    class Other(gymnasium.Env):
        observation_space = gymnasium.spaces.Box(0, 255, (3, 36, 36), np.uint8)
        action_space = gymnasium.spaces.Discrete(7)

        def reset(self, *, seed=None, options=None):
            return self.observation_space.sample(), {}

    model = library.PPO("CnnPolicy", Other(), n_steps=8, batch_size=8, device="cpu")
    model.save(tmp_path / "model.zip")
    Sb3Policy(tmp_path / "model.zip", {"action_repeat": 1}, sampled=False)
    assert not caplog.records
    Sb3Policy(tmp_path / "model.zip", {}, sampled=False)
    assert "--set env.action_repeat=4 changes it" in caplog.text


def test_a_network_as_training_writes_it_flies(onnx, fly, tmp_path):
    torch = pytest.importorskip("torch")
    from eyas.engine.settings.env import EnvConfig
    from eyas.learning.export import export
    from eyas.learning.network import NetworkShape, TrackingNetwork

    network = TrackingNetwork(NetworkShape(3, 48, 48, hidden=32, memory=True))
    network.initialise(torch.Generator().manual_seed(1))
    seen = {"width": 48, "height": 48, "layout": "chw"}
    path = tmp_path / "policy.onnx"
    export(network, EnvConfig(observation=seen, action_repeat=25), path)
    records = fly(str(path))
    assert [record.error for record in records] == [None] * 4
    assert fly(str(path)) == records
