"""The examples run; those of maps and of published figures have tests of their own."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.traffic.sumo_install import import_libsumo
from eyas.engine.world.maps import MAPS

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    yield
    for name in ("ppo", "own_observation", "own_map", "custom_map", "own_tracker"):
        sys.modules.pop(name, None)


def test_an_observation_of_ones_own_has_edges_and_motion(capsys):
    import own_observation

    own_observation.main()
    assert (
        "'edges': (8, 1, 48, 47), 'motion': (8, 2), 'privileged': (8, 16)"
        in capsys.readouterr().out
    )
    env = own_observation.EyasVectorEnv(
        2,
        observation={"parts": ["image", "sensors", "privileged"], "width": 48, "height": 48,
                     "colours": "grey", "layout": "chw"},
    )  # fmt: skip
    plain, _ = env.reset(seed=1)
    seen, _ = own_observation.EdgesAndMotion(env).reset(seed=1)
    left, right = plain["image"][..., :-1].astype(int), plain["image"][..., 1:].astype(int)
    assert np.array_equal(seen["edges"], np.abs(right - left))
    assert np.allclose(seen["motion"][:, 0] * 25.0, plain["sensors"][:, 2])


@pytest.mark.slow
def test_a_tracker_of_ones_own_flies_a_curve(capsys):
    import own_tracker

    own_tracker.main()
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 5
    assert lines[-1].startswith("bank, pitch, heading: [-0.4")


def test_proximal_policy_optimisation_in_one_file_learns_and_repeats_itself(tmp_path, capsys):
    torch = pytest.importorskip("torch")
    torch.set_num_threads(1)  # on a busy machine, more wait for each other
    import ppo

    options = ppo.Options(decisions=128, num_envs=4, num_steps=16, save=str(tmp_path / "a.pt2"))
    curve = ppo.main(options)
    assert len(curve) == 2
    assert capsys.readouterr().out.count("entropy") == 2
    options.save = str(tmp_path / "b.pt2")
    assert ppo.main(options) == curve
    learnt, again = (torch.export.load(tmp_path / f"{name}.pt2").state_dict for name in "ab")
    torch.manual_seed(options.seed)
    agent = ppo.Agent()
    fresh = ppo.nn.Sequential(agent.body, agent.policy).state_dict()
    for name, weights in learnt.items():
        assert torch.equal(weights, again[name])
        assert not torch.equal(weights, fresh[name])
    command = [sys.executable, "-m", "eyas.cli.main", "evaluate", "--quiet", "--episodes", "1"]
    command += ["--policy", str(tmp_path / "a.pt2"), "--out", str(tmp_path / "flown")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_its_advantages_are_those_of_sums_of_errors():
    torch = pytest.importorskip("torch")
    import ppo

    options, data = ppo.Options(discount=0.9, trace=0.5), ppo.Rollout(3, 1)
    data.values[:, 0] = torch.tensor([1.0, 2.0, 3.0])
    data.rewards[:, 0] = torch.tensor([0.5, 0.25, 2.0])
    data.ended[1, 0] = 1.0
    found = data.advantages(torch.tensor([4.0]), options)[:, 0]
    last, cut = 2.0 + 0.9 * 4.0 - 3.0, 0.25 - 2.0
    assert found.tolist() == pytest.approx([0.5 + 0.9 * 2.0 - 1.0 + 0.45 * cut, cut, last])


@pytest.mark.sumo
@pytest.mark.slow
def test_a_network_is_trained_on_a_map_of_ones_own(tmp_path, monkeypatch, capsys):
    torch = pytest.importorskip("torch")
    pytest.importorskip("onnx")
    try:
        import_libsumo()
    except MissingExtraError as error:
        pytest.skip(str(error))
    monkeypatch.setattr(MAPS, "_table", dict(MAPS._table))  # the name is gone after the test
    threads = torch.get_num_threads()
    import custom_map

    policy = custom_map.main(1024, tmp_path / "field")
    torch.set_num_threads(threads)
    assert policy.is_file()
    rows = (tmp_path / "field" / "curve.csv").read_text().splitlines()
    assert len(rows) == 2
    assert f"--policy {policy} --map own_map:FIELD" in capsys.readouterr().out
