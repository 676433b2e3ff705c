"""LeRobot reads the first and the last frame of each episode as they were recorded."""

import json
import os
import sys
from pathlib import Path

import numpy as np
from PIL import Image

os.environ["HF_HUB_OFFLINE"] = "1"

from lerobot.datasets.lerobot_dataset import LeRobotDataset

recording = Path(sys.argv[1])
root = recording / "exports" / "lerobot"
data = LeRobotDataset("eyas/check", root=root, video_backend="torchcodec")
folders = sorted(recording.glob("*/episode*"), key=lambda path: path.parts[-2:])
assert data.num_episodes == len(folders), (data.num_episodes, len(folders))
first = 0
for folder in folders:
    labels = [json.loads(line) for line in (folder / "labels.jsonl").read_text().splitlines()]
    for number in (0, len(labels) - 1):
        item, label = data[first + number], labels[number]
        picture = np.asarray(Image.open(folder / f"{number:06d}.jpeg"), np.float64) / 255
        shown = item["observation.images.camera"].permute(1, 2, 0).numpy()
        error = float(np.sqrt(((picture - shown) ** 2).mean()))
        assert error < 0.05, f"{folder}, frame {number}: pictures differ by {error:.3f}"
        state = [*label["tracker_position"], *label["tracker_velocity"]]
        assert np.allclose(item["observation.state"][:6], state, atol=1e-3)
        assert item["task"] == f"Follow {labels[0]['target_words']}."
        assert abs(float(item["timestamp"]) - number / data.fps) < 1e-4
    first += len(labels)
assert data.num_frames == first
print(f"lerobot: {data.num_episodes} episodes, {data.num_frames} frames")
