"""An algorithm of a user's own: found, given its settings, told, resumed; also after a teacher."""

import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")

from eyas.cli.main import main
from eyas.engine.core.config import updated, validated
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.learning.algorithm import Algorithm
from eyas.learning.config import ALGORITHMS
from eyas.learning.trainer import train

EXAMPLES = Path(__file__).parents[2] / "examples"
OWN = "own_algorithm:Reinforce"

SMALL = validated(
    EyasConfig,
    {
        "env": {"action_repeat": 4, "observation": {"width": 24, "height": 24, "layout": "chw"}},
        "train": {
            "method": OWN,
            "own": {"entropy": 0.5},
            "environments": 4,
            "n_steps": 8,
            "updates_per_block": 2,
            "hidden": 16,
            "evaluation": {"every": 0},
            "stages": [{"total_timesteps": 128}],
        },
    },
)
"""Two blocks of 64 decisions."""


@pytest.fixture(autouse=True)
def importable(monkeypatch):
    monkeypatch.syspath_prepend(EXAMPLES)
    yield
    sys.modules.pop("own_algorithm", None)


def trained(folder, stop=None, resume=False, **changes):
    """Train; return the last lines, and the files that tell what was learned."""
    lines = []

    def say(line):
        lines.extend([line] if "return" in line else [])  # of blocks
        if len(lines) == stop:
            raise KeyboardInterrupt

    config = updated(SMALL, {"train": changes})
    if stop is None:
        train(config, folder, resume=resume, say=say)
    else:
        with pytest.raises(KeyboardInterrupt):
            train(config, folder, resume=resume, say=say)
    names = ("curve.csv", "policy.onnx", "checkpoint.pt")
    return lines, {name: (folder / name).read_bytes() for name in names if stop is None}


def test_a_run_goes_on_with_the_state_that_it_had(tmp_path):
    lines, whole = trained(tmp_path / "whole")
    trained(tmp_path / "cut", stop=2)  # the first block is in the checkpoint
    _, again = trained(tmp_path / "cut", resume=True)
    assert again == whole
    kept = torch.load(tmp_path / "whole" / "checkpoint.pt", weights_only=True)[OWN]
    assert kept["scale"] not in (1.0, 0.0)
    assert len(lines) == 2
    assert all("  loss " in line for line in lines)
    head, *rows = (row.split(",") for row in whole["curve.csv"].decode().splitlines())
    assert head[5:8] == ["policy_loss", "value_loss", "scale"]
    assert float(rows[-1][7]) == pytest.approx(kept["scale"], rel=1e-6)


def test_other_code_does_not_go_on(tmp_path, monkeypatch):
    trained(tmp_path / "run")
    (tmp_path / "own_algorithm.py").write_text((EXAMPLES / "own_algorithm.py").read_text() + "\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "own_algorithm", raising=False)
    with pytest.raises(EyasError, match=r"run: taught by other code, own_algorithm:\w+ \w{12};"):
        trained(tmp_path / "run", resume=True)


def test_its_settings_are_checked_and_change_what_is_learned(tmp_path):
    (_, one), (_, other) = trained(tmp_path / "a"), trained(tmp_path / "b", own={"entropy": 0.0})
    assert one["policy.onnx"] != other["policy.onnx"]
    with pytest.raises(EyasError, match=r"^train\.own\.entropi: unknown key.*'entropy'"):
        trained(tmp_path / "c", own={"entropi": 1.0})


def test_a_teacher_may_teach_before_it(tmp_path):
    _, files = trained(tmp_path, method=f"dagger+{OWN}", dagger={"total_timesteps": 64})
    head, *rows = (row.split(",") for row in files["curve.csv"].decode().splitlines())
    told = [(row[head.index("agreement")], row[head.index("policy_loss")]) for row in rows]
    assert [(first == "nan", second == "nan") for first, second in told] == [
        (False, True),
        (True, False),
    ]


def test_figures_that_are_not_its_columns_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(ALGORITHMS.get(OWN), "columns", ("policy_loss",))
    with pytest.raises(ValueError, match="longer than argument 1"):
        trained(tmp_path)


def test_an_installed_package_adds_one_by_name(tmp_path, monkeypatch):
    info = tmp_path / "town-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: town\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[eyas.algorithms]\nreinforce = {OWN}\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(ALGORITHMS, "_points", entry_points(group="eyas.algorithms"))
    monkeypatch.setattr(ALGORITHMS, "_loaded", {})
    assert issubclass(ALGORITHMS.get("reinforce"), Algorithm)
    _, files = trained(tmp_path / "run", method="reinforce")
    assert b"policy_loss" in files["curve.csv"]


@pytest.mark.parametrize("name", ALGORITHMS.built_in)
def test_each_algorithm_of_the_table_is_there_and_has_a_section(name):
    found = ALGORITHMS.get(name)
    section = getattr(EyasConfig().train, {"pursuit": "ppo"}.get(name, name))  # two networks by PPO
    if isinstance(found, type):
        assert isinstance(section, found.Settings)
        assert found.columns
    elif name != "pursuit":
        assert section.scaled(section.pictures), "it learns from pictures"


def test_it_is_code_that_settings_name(monkeypatch, tmp_path, capsys):
    (tmp_path / "mine.json").write_text(SMALL.model_dump_json())
    given = ["--config", f"{tmp_path}/mine.json", "--out", f"{tmp_path}/run"]
    monkeypatch.setattr(sys, "argv", ["eyas", "train", *given])
    with pytest.raises(SystemExit):
        main()
    assert "--trust" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_the_example_runs(tmp_path, capsys):
    import own_algorithm

    threads = torch.get_num_threads()
    assert own_algorithm.main(2048, tmp_path / "run").is_file()
    torch.set_num_threads(threads)
    assert "  loss " in capsys.readouterr().out
