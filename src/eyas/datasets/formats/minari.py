"""Minari: `eyas/<recording>-v0/data/main_data.hdf5`, exact pictures.

As https://github.com/Farama-Foundation/Minari reads it with `MINARI_DATASETS_PATH` set to the
folder of the export. Minari itself would make lossy JPEGs of pictures unless told otherwise.
"""

import io
import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.datasets.motion import STATE_NAMES, TRUTH_NAMES, action_names, motion_of, task_of
from eyas.engine.core.errors import MissingExtraError, OutputError
from eyas.engine.core.files import atomic_path
from eyas.engine.recordings.format import KEPT, Exported, ExportJob, Format
from eyas.engine.recordings.recording import RecordedEpisode

Row = dict[str, Any]

_MARGIN = 1 << 16  # What an episode may take more than its part [bytes]


class Minari(Format):
    """One HDF5 file with all episodes; frame k + 1 is the observation that action k leads to.

    Raises:
        MissingExtraError: h5py is not installed.
    """

    needs = frozenset({"jpeg", "labels"})

    def __init__(self, job: ExportJob) -> None:
        try:
            import h5py
        except ImportError as error:
            raise MissingExtraError("the format 'minari'", "exports") from error
        self.job, self._h5 = job, h5py

    def add(self, episode: RecordedEpisode) -> None:
        """Write its part, a file of its own."""
        motion, count = motion_of(episode), len(episode)
        width, height = episode.size
        ends = np.array([label["done"] for label in episode.labels[1:]], np.bool_)
        last = np.arange(count - 1) == count - 2
        # In memory: HDF5 ends the process when it closes a file that it cannot write.
        stored = io.BytesIO()
        with self._h5.File(stored, "w") as file:
            seen = file.create_group("observations")
            pictures = seen.create_dataset(
                "image",
                (count, height, width, 3),
                np.uint8,
                chunks=(1, height, width, 3),
                compression="gzip",
                compression_opts=1,
            )
            for frame in episode:
                pictures[frame.number] = frame.picture()
            seen["state"], seen["environment_state"] = motion.states, motion.truth
            file["actions"] = motion.actions[:-1]
            file["rewards"] = motion.rewards[1:].astype(np.float64)
            file["terminations"], file["truncations"] = ends, last & ~ends
        self.job.write(f"{KEPT}/{episode.name}.hdf5", stored.getvalue())
        about = {
            "task": task_of(episode),
            "size": [height, width],
            "action": motion.actions.shape[1],
        }
        self.job.keep(episode, {"seed": episode.config.seed, **about})

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Join the episodes, and describe the data set."""
        folder = Path("eyas", f"{_plain(self.job.name)}-v0", "data")
        path = self.job.folder / folder / "main_data.hdf5"
        path.parent.mkdir(parents=True, exist_ok=True)
        self._require_space(path, [episode.name for episode in episodes])
        kept = [self.job.kept(episode.name) for episode in episodes]
        with atomic_path(path) as part, self._h5.File(part, "w", track_order=True) as file:
            for number, (episode, about) in enumerate(zip(episodes, kept, strict=True)):
                group = file.create_group(f"episode_{number}")
                own = self.job.folder / KEPT / f"{episode.name}.hdf5"
                with self._h5.File(own, "r") as stored:
                    for name in stored:
                        stored.copy(name, group)
                group.attrs.update(
                    {
                        "id": number,
                        "seed": about["seed"],
                        "total_steps": episode.frames - 1,
                        "task": about["task"],
                        "split": episode.split,
                        "name": episode.name,
                    }
                )
        steps = sum(episode.frames - 1 for episode in episodes)
        size = round(path.stat().st_size / 1e6, 1)
        names = folder.parent.as_posix(), len(action_names(each["action"] for each in kept))
        about = _metadata(*names, len(episodes), steps, kept[0]["size"], size)
        self.job.write((folder / "metadata.json").as_posix(), json.dumps(about) + "\n")
        self.job.write("eyas/namespace_metadata.json", json.dumps({"description": "Eyas"}) + "\n")

    def _require_space(self, path: Path, names: Sequence[str]) -> None:
        """Refuse to join what the disk cannot hold, see `add`."""
        parts = (self.job.folder / KEPT / f"{name}.hdf5" for name in names)
        needed = sum(part.stat().st_size + _MARGIN for part in parts)
        if shutil.disk_usage(path.parent).free < needed:
            raise OutputError(f"{path}: cannot write: it needs {needed >> 20} MiB, and the disk "
                              "has less left")  # fmt: skip


def _plain(name: str) -> str:
    return re.sub(r"[^\w]+", "-", name).strip("-") or "recording"


def _metadata(
    name: str, action: int, episodes: int, steps: int, size: Sequence[int], megabytes: float
) -> Row:
    height, width = size
    # Minari's Box spells out the limits of every number.
    image = np.zeros((height, width, 3), np.uint8)
    inputs = {
        "image": _box(image, image + np.uint8(255)),
        "state": _unlimited(len(STATE_NAMES)),
        "environment_state": _unlimited(len(TRUTH_NAMES)),
    }
    return {
        "dataset_id": name,
        "total_episodes": episodes,
        "total_steps": steps,
        "data_format": "hdf5",
        "jpeg_encoding": False,
        "observation_space": json.dumps({"type": "Dict", "subspaces": inputs}),
        "action_space": json.dumps(_unlimited(action)),
        "dataset_size": megabytes,
        "minari_version": "0.5.0",
        "description": "Recorded with Eyas: pictures, states, and velocities in the body's axes.",
    }


def _unlimited(count: int) -> Row:
    limit = np.full(count, np.inf, np.float32)
    return _box(-limit, limit)


def _box(low: NDArray[Any], high: NDArray[Any]) -> Row:
    limits = {"low": low.tolist(), "high": high.tolist()}
    return {"type": "Box", "dtype": str(low.dtype), "shape": list(low.shape), **limits}
