"""Make docs/images/flights.jpg: some frames of an episode of each camera path.

`python tools/flight_sheet.py docs/images/flights.jpg`
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

from eyas.engine.core.config import updated
from eyas.engine.exports.label import read_labels
from eyas.engine.settings.config import EyasConfig
from eyas.engine.video import run as video

SHOWN = {
    "follow": ("citystreet", 5),
    "orbit": ("downtown", 1),
    "fly-by": ("village", 3),
    "rise": ("citystreet", 2),
    "zoom": ("downtown", 2),
    "hover-and-pan": ("farmland", 1),
    "search": ("citystreet", 4),
}
"""Map and seed of each path."""

PITCH = {"pitch": {"uniform": [0.4, 1.1]}}

COLUMNS, FRAMES = 7, 300
WIDTH, HEIGHT = 200, 150


def strip(name: str, map_name: str, seed: int, folder: Path) -> Image.Image:
    """Return frames of an episode side by side, with a box around the target."""
    recorded = {"channels": 1, "flight": name, "episode_frames": FRAMES}
    recorded["writers"] = ["jpeg", "labels"]
    settings = {"world": {"map": map_name}, "camera": {"samples": 4}, "start": PITCH}
    settings["video"] = recorded
    video.run(updated(EyasConfig(seed=seed), settings), folder, quiet=True)
    episode = folder / "DRONE0" / "episode0"
    labels = read_labels(episode / "labels.jsonl")
    row = Image.new("RGB", (COLUMNS * WIDTH, HEIGHT))
    for column in range(COLUMNS):
        label = labels[column * (len(labels) - 1) // (COLUMNS - 1)]
        picture = Image.open(episode / f"{label['frame']:06}.jpeg").convert("RGB")
        left, top, right, bottom = label["target_box"]
        if right > left:
            ImageDraw.Draw(picture).rectangle((left, top, right - 1, bottom - 1), outline="red")
        row.paste(picture.resize((WIDTH, HEIGHT)), (column * WIDTH, 0))
    ImageDraw.Draw(row).text((5, 3), name, fill="white", stroke_width=2, stroke_fill="black")
    return row


def main() -> None:
    """Write the picture."""
    sheet = Image.new("RGB", (COLUMNS * WIDTH, len(SHOWN) * (HEIGHT + 2)))
    with tempfile.TemporaryDirectory() as folder:
        for number, (name, (map_name, seed)) in enumerate(SHOWN.items()):
            row = strip(name, map_name, seed, Path(folder) / name)
            sheet.paste(row, (0, number * (HEIGHT + 2)))
    sheet.save(sys.argv[1], quality=82)


if __name__ == "__main__":
    main()
