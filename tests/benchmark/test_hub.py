"""A policy on the Hugging Face hub, of which a stand-in runs on this machine."""

import os
import subprocess
import sys

import pytest

from eyas.benchmark.policies.shipped import file_of
from eyas.benchmark.report.reproduce.hub_card import hub_files
from tests.kit.hub import running_hub

pytestmark = pytest.mark.slow
pytest.importorskip("huggingface_hub", reason="extra hub")


def test_a_policy_is_published_with_its_card(tmp_path):
    with running_hub() as hub:
        environment = os.environ | hub.environment()
        command = [sys.executable, "-m", "eyas", "policies", "push", "fast", "fast"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert done.stdout == f"{hub.address}/someone/fast\n", done.stderr
        again = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert again.returncode == 0
    arrived = hub.repositories["model", "someone/fast"]
    assert not arrived["private"]
    assert arrived["files"]["fast.onnx"] == file_of("fast").read_bytes()
    assert "hf download someone/fast fast.onnx" in arrived["files"]["README.md"].decode()


def test_its_card_has_the_figures_in_the_format_of_the_hub():
    import huggingface_hub

    card = huggingface_hub.ModelCard(hub_files("fast", "me/fast")["README.md"].decode())
    assert card.data.license == "mit"
    assert card.data.library_name == "eyas"
    figures = {
        (each.dataset_name, each.metric_type): each.metric_value for each in card.data.eval_results
    }
    assert 0.8 < figures["Eyas, `standard`: `fast`, citystreet by day", "tsr"] < 1.0
    assert "](../" not in card.content


def test_the_network_of_a_training_brings_what_lies_beside_it(tmp_path):
    network = tmp_path / "policy.onnx"
    network.write_bytes(file_of("fast").read_bytes())
    (tmp_path / "curve.csv").write_text("decisions\n")
    (tmp_path / "checkpoint.pt").write_bytes(b"large")
    files = hub_files(str(network), "me/mine")
    assert files.keys() == {"policy.onnx", "curve.csv", "README.md"}
    assert b"eyas evaluate --policy policy.onnx" in files["README.md"]


def test_what_is_no_policy_is_not_published(tmp_path, eyas_command):
    assert (
        "POLICY: 'fsat' is not allowed" in eyas_command("policies", "push", "fsat", "me/x").stderr
    )
    file = tmp_path / "x.onnx"
    file.write_bytes(b"nothing")
    done = eyas_command("policies", "push", file, "me/x")
    assert done.returncode == 2
    assert str(file) in done.stderr
