"""Let loaders and scorers of others read what `eyas export` writes, each in its own environment.

    python tools/check_peers.py                  # all; lerobot and agents download several GB
    python tools/check_peers.py trackeval        # only these
    python tools/check_peers.py --venvs DIR      # keep the environments there, for the next time

These conflict with what Eyas or its tests need: TrackEval brings another OpenCV, nuscenes-devkit
wants NumPy 1, LeRobot an older PyAV, vot-toolkit a trick. Run it with a Python that has Eyas and
its extra `exports`: it records a small flight, exports it, makes each environment, and runs
`tools/peers/read_<name>.py FOLDER` in it, which fails if something is not as it should be.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PEERS = ROOT / "tools" / "peers"


class Peer(NamedTuple):
    """What a check needs."""

    formats: tuple[str, ...]
    """Formats of `eyas export` that it reads."""
    packages: tuple[tuple[str, ...], ...]
    """What pip installs, one call after the other."""


# TorchCodec wants FFmpeg's libraries (apt install ffmpeg).
_LEROBOT = (
    ("torch==2.14.1", "torchvision==0.29.1", "torchcodec"),
    ("datasets>=4,<4.2", "av<16", "numpy<2.3", "jsonlines", "draccus", "huggingface_hub"),
    ("packaging", "einops", "deepdiff", "imageio", "opencv-python-headless", "gymnasium"),
    ("accelerate", "termcolor", "rerun-sdk", "diffusers", "pandas"),
    ("--no-deps", "lerobot==0.4.4"),
)

CHECKS = {
    "trackeval": Peer(("mot", "kitti"), (("trackeval>=1.3", "setuptools"),)),
    "vot": Peer(("vot",), (("vot-toolkit", "setuptools"),)),
    "nuscenes": Peer(("nuscenes",), (("nuscenes-devkit>=1.2", "setuptools"),)),
    "lerobot": Peer(("lerobot",), _LEROBOT),
    # With Eyas beside them, which flies what they have learned.
    "agents": Peer(
        ("lerobot",),
        (*_LEROBOT, ("transformers<5", "pyserial", "pynput", "wandb<0.25"), ("-e", str(ROOT))),
    ),
}

SETTINGS = (
    *("camera.width=320", "camera.height=240", "camera.field_of_view=1.2", "video.channels=2"),
    *("video.fps=10", "video.total_time=4", "video.flight=follow"),
    'video.writers=["jpeg", "labels", "masks", "mp4"]',
)


def main() -> int:
    """Run the checks that were asked for; return 1 if one has failed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", choices=[*CHECKS, []], help="which ones")
    parser.add_argument("--venvs", type=Path, help="folder of the environments")
    said = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        venvs, recording = said.venvs or Path(scratch), Path(scratch, "recording")
        video = [sys.executable, "-m", "eyas", "video", "--quiet", "--out", str(recording)]
        subprocess.run([*video, *(f"--set={one}" for one in SETTINGS)], check=True)
        names = said.names or CHECKS
        failed = [name for name in names if not passes(name, recording, venvs / name)]
    print("failed:", *failed) if failed else print("all passed")
    return bool(failed)


def passes(name: str, recording: Path, venv: Path) -> bool:
    """Return whether a peer reads what it should."""
    peer = CHECKS[name]
    formats = [f"--format={one}" for one in peer.formats]
    export = [sys.executable, "-m", "eyas", "export", str(recording), *formats, "--quiet"]
    subprocess.run(export, check=True)
    python = venv / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(venv)], check=True)
        for packages in peer.packages:
            subprocess.run([str(python), "-m", "pip", "install", "-q", *packages], check=True)
    print(f"== {name}", flush=True)
    check = [str(python), str(PEERS / f"read_{name}.py"), str(recording)]
    return subprocess.run(check, check=False).returncode == 0


if __name__ == "__main__":
    sys.exit(main())
