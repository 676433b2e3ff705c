"""Draw a sheet of people seen from a drone: 24 of them, at 4, 6, 9 and 13 m.

python tools/people_sheet.py docs/images/people.jpg
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from eyas.cli.targets.show import StageCamera, TargetPose, TargetStage
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of

FIELD = np.deg2rad(45.0)
DISTANCES = (4.0, 6.0, 9.0, 13.0)
ELEVATIONS = (0.35, 0.55, 0.8)
BEARINGS = (0.3, 2.4, -2.9, -0.9, 1.5, np.pi)
TILE = 150
"""Height and width of what is shown of each [pixels]."""


def seen(stage: TargetStage, index: int, place: int, distance: float) -> np.ndarray:
    """Return a walker in the middle of a square that is 1.5 times as high as the walker."""
    colours = KINDS[kind_index("Pedestrian")].colours
    pose = TargetPose(travelled=0.41 * place, speed=1.3, individual=place)
    camera = StageCamera(
        bearing=BEARINGS[place % len(BEARINGS)],
        elevation=ELEVATIONS[place % len(ELEVATIONS)],
        distance=distance,
        field_of_view=FIELD,
    )
    colour = colours[place % len(colours)]
    picture = stage.draw(index, colour, [(pose, camera)], (480, 640))[0]
    half = int(0.75 * MODELS[index].height * 320 / np.tan(FIELD / 2) / distance)
    tile = np.asarray(
        Image.fromarray(picture).crop((320 - half, 240 - half, 320 + half, 240 + half))
    )
    return np.asarray(Image.fromarray(tile).resize((TILE, TILE), Image.Resampling.BICUBIC))


def main() -> None:
    """Draw the sheet into the file that the command names."""
    stage = TargetStage(["Pedestrian"])
    models = list(models_of(kind_index("Pedestrian")))
    step = max(len(models) // 24, 1)
    rows = []
    for distance in DISTANCES:
        tiles = [
            seen(stage, models[place * step % len(models)], place, distance) for place in range(24)
        ]
        rows += [np.concatenate(tiles[first : first + 8], axis=1) for first in range(0, 24, 8)]
    sheet = Image.fromarray(np.concatenate(rows))
    sheet.save(Path(sys.argv[1]), quality=82)


if __name__ == "__main__":
    main()
