"""`eyas serve --ros` as a process of its own, heard and flown by what a node is on the wire."""

import importlib.util
import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

if importlib.util.find_spec("cyclonedds") is None:
    pytest.skip("needs cyclonedds", allow_module_level=True)

NODE = Path(__file__).with_name("ros_node.py")
DOMAIN = "141"


@pytest.mark.slow
def test_a_node_hears_and_flies_it():
    small = ["--set", "camera.width=96", "--set", "camera.height=54", "--set", "video.fps=10"]
    words = [sys.executable, "-m", "eyas", "serve", "--ros", DOMAIN, *small]
    server = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    try:
        # Lines on what is made for the first time may come before it.
        assert any("on the air" in line for line in server.stderr)
        node = [sys.executable, str(NODE), DOMAIN]
        said = subprocess.run(node, capture_output=True, text=True, timeout=150, check=False)
        assert server.poll() is None
    finally:
        server.kill()
        server.wait()
        server.stderr.close()
    assert said.returncode == 0, said.stderr
    heard = json.loads(said.stdout)
    begun, ended = heard["places"]
    took = heard["seconds"][1] - heard["seconds"][0]
    assert 1.0 < took < 4.0
    assert math.dist(begun[:2], ended[:2]) > 2.0
    assert ended[2] - begun[2] > 1.0
    assert heard["speeds"][0] == pytest.approx(0.0, abs=0.05)
    assert heard["speeds"][-1] == pytest.approx(2.0, abs=0.7)
    assert heard["jpeg"][0] == "ffd8ff"
    assert heard["frames"] == ["odom", "camera_optical_frame"]
    assert set(heard["static"]) >= {"odom", "camera_optical_frame"}
    assert heard["looks"][1] - heard["looks"][0] < -0.2  # it looks up, further from straight down
