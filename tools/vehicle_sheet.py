"""Draw the picture of docs/targets.md: all cars with their variants, from behind and above at 13 m.

python tools/vehicle_sheet.py docs/images/vehicles.jpg
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from eyas.cli.targets.show import StageCamera, TargetPose, TargetStage
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index

BEARINGS = (np.pi, 2.4, -2.1, 0.6)
FIELD = np.deg2rad(45.0)
SHOWN = 250, 330
"""Height and width of what is cut out of a picture of 480 x 640 [pixels]."""


def cut(picture: np.ndarray) -> np.ndarray:
    """Return the middle of a picture."""
    (height, width), (high, wide) = picture.shape[:2], SHOWN
    top, left = (height - high) // 2, (width - wide) // 2
    return picture[top : top + high, left : left + wide]


def row(stage: TargetStage, index: int, place: int) -> np.ndarray:
    """Return the individuals of a model side by side, each from another side."""
    distance = 13.0 * max(1.0, MODELS[index].length / 4.9)
    shown = []
    for individual, bearing in enumerate(BEARINGS):
        pose = TargetPose(travelled=0.3, speed=5.0, individual=individual)
        camera = StageCamera(bearing=bearing, elevation=0.8, distance=distance, field_of_view=FIELD)
        colours = KINDS[kind_index("passenger")].colours
        colour = colours[(3 * place + 2 * individual) % len(colours)]
        shown.append(cut(stage.draw(index, colour, [(pose, camera)], (480, 640))[0]))
    return np.concatenate(shown, axis=1)


def main() -> None:
    """Draw the sheet into the file that the command names."""
    kinds = ("passenger", "bus", "truck", "trailer", "motorcycle")
    stage = TargetStage(kinds)
    models = [k for k, model in enumerate(MODELS) if model.kind in kinds]
    rows = [row(stage, index, place) for place, index in enumerate(models)]
    half = (len(rows) + 1) // 2
    rows += [np.full_like(rows[0], 255)] * (2 * half - len(rows))
    columns = [np.concatenate(part) for part in (rows[:half], rows[half:])]
    sheet = Image.fromarray(np.concatenate(columns, axis=1))
    sheet.resize((sheet.width // 2, sheet.height // 2)).save(Path(sys.argv[1]), quality=88)


if __name__ == "__main__":
    main()
