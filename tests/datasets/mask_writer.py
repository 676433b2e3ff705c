"""Masks as the writer `masks` makes them."""

import numpy as np
from PIL import Image

from eyas import Files, Summary, Writer
from eyas.exports.writer import EpisodeWriter


class Masks(Writer):
    wants = frozenset({"object_id"})
    files = Files(frame=("masks/{:06d}.png",))

    def begin(self, episode):
        (episode.folder / "masks").mkdir(parents=True, exist_ok=True)
        return MasksEpisode(episode.folder)

    def read(self, folder):
        return Summary(len(list((folder / "masks").glob("*.png"))))


class MasksEpisode(EpisodeWriter):
    def __init__(self, folder):
        self.folder = folder

    def add(self, frame):
        ids = np.maximum(frame.object_id - 65535, 0).astype(np.uint16)
        Image.fromarray(ids).save(self.folder / "masks" / f"{frame.number:06d}.png")
