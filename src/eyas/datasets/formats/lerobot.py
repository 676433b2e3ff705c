"""LeRobot data sets, version 3.0: states, actions, task in words, videos, statistics.

As `LeRobotDataset(root=...)` of https://github.com/huggingface/lerobot reads them: tables in
Parquet files, one episode a file of each kind, so that no video is encoded again.
"""

import io
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eyas.datasets.motion import STATE_NAMES, TRUTH_NAMES, action_names, motion_of, task_of
from eyas.engine.core.decoding import npz_arrays
from eyas.engine.core.errors import DataFileError, MissingExtraError
from eyas.engine.core.files import read_limited
from eyas.engine.recordings.format import KEPT, Exported, ExportJob, Format
from eyas.engine.recordings.recording import RecordedEpisode

if TYPE_CHECKING:
    import pyarrow

_LARGEST = 1 << 28  # Largest arrays of an episode [bytes]

CAMERA = "observation.images.camera"
_CHUNK = 1000  # Files in a folder
_LOOKED_AT = 16  # Pictures of an episode by which the statistics of its colours are estimated

_FEATURES = {"observation.state": STATE_NAMES, "teacher.truth": TRUTH_NAMES}
"""LeRobot gives a policy whatever is called `observation`, and so not what only a teacher knows."""

_ACTION = "action"
_COUNTERS = ("timestamp", "frame_index", "episode_index", "index", "task_index")

Stats = dict[str, list[Any]]
Row = dict[str, Any]


class LeRobot(Format):
    """`meta/`, `data/chunk-000/file-000.parquet`, `videos/.../chunk-000/file-000.mp4`.

    Raises:
        MissingExtraError: PyArrow is not installed.
    """

    needs = frozenset({"jpeg", "labels", "mp4"})

    def __init__(self, job: ExportJob) -> None:
        try:
            import pyarrow as pa
            import pyarrow.parquet as pq
        except ImportError as error:
            raise MissingExtraError("the format 'lerobot'", "exports") from error
        self.job, self._pa, self._pq = job, pa, pq

    def add(self, episode: RecordedEpisode) -> None:
        """Keep its video, and its states and actions."""
        self.job.place(episode.folder / "episode.mp4", f"{KEPT}/{episode.name}.mp4")
        motion = motion_of(episode)
        arrays: dict[str, Any] = {
            "observation.state": motion.states,
            "teacher.truth": motion.truth,
            _ACTION: motion.actions,
            "next.reward": np.nan_to_num(motion.rewards)[:, None],
            "next.done": np.array([[label["done"]] for label in episode.labels]),
        }
        stored = io.BytesIO()
        np.savez(stored, **arrays)
        self.job.write(f"{KEPT}/{episode.name}.npz", stored.getvalue())
        width, height = episode.size
        kept = {
            "fps": episode.fps,
            "size": [height, width],
            "task": task_of(episode),
            "colours": _colour_stats(episode),
            _ACTION: motion.actions.shape[1],
        }
        self.job.keep(episode, kept)

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Write the tables and the descriptions, the splits one after the other."""
        order = sorted(episodes, key=lambda each: ("train", "val", "test").index(each.split))
        names = action_names(self.job.kept(each.name)[_ACTION] for each in order)
        tasks: dict[str, int] = {}
        rows: list[Row] = []
        for number, episode in enumerate(order):
            kept = self.job.kept(episode.name)
            task = tasks.setdefault(kept["task"], len(tasks))
            first = sum(row["length"] for row in rows)
            rows.append(self._episode(number, episode, kept, task, first))
        self._write_table("meta/tasks.parquet", self._tasks(tasks))
        columns = {name: [row[name] for row in rows] for name in rows[0]}
        self._write_table("meta/episodes/chunk-000/file-000.parquet", self._pa.table(columns))
        first_kept = self.job.kept(order[0].name)
        self._write_json("meta/info.json", _info(order, first_kept, len(tasks), names))
        self._write_json("meta/stats.json", _all_stats(rows))

    def _episode(self, number: int, episode: Exported, kept: Row, task: int, first: int) -> Row:
        """Write the data of an episode and place its video; return its row."""
        chunk, file = divmod(number, _CHUNK)
        inside = f"chunk-{chunk:03d}/file-{file:03d}"
        self.job.settle(f"{episode.name}.mp4", f"videos/{CAMERA}/{inside}.mp4")
        count = episode.frames
        path = self.job.folder / KEPT / f"{episode.name}.npz"
        try:
            arrays = npz_arrays(read_limited(path, _LARGEST), _LARGEST)
        except Exception as error:  # damaged bytes raise many kinds in zipfile, zlib, numpy
            raise DataFileError(f"{path}: {error}; start again with --overwrite") from None
        counters = {
            "timestamp": np.arange(count, dtype=np.float64) / kept["fps"],
            "frame_index": np.arange(count),
            "episode_index": np.full(count, number),
            "index": np.arange(first, first + count),
            "task_index": np.full(count, task),
        }
        counters["timestamp"] = counters["timestamp"].astype(np.float32)
        self._write_table(f"data/{inside}.parquet", self._data(arrays, counters))
        stats = {name: _stats(values) for name, values in (arrays | counters).items()}
        stats[CAMERA] = kept["colours"]
        return {
            "episode_index": number,
            "tasks": [kept["task"]],
            "length": count,
            "data/chunk_index": chunk,
            "data/file_index": file,
            "dataset_from_index": first,
            "dataset_to_index": first + count,
            f"videos/{CAMERA}/chunk_index": chunk,
            f"videos/{CAMERA}/file_index": file,
            f"videos/{CAMERA}/from_timestamp": 0.0,
            f"videos/{CAMERA}/to_timestamp": count / kept["fps"],
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
            **{
                f"stats/{name}/{kind}": value
                for name, own in stats.items()
                for kind, value in own.items()
            },
        }

    def _data(
        self, arrays: Mapping[str, NDArray[Any]], counters: Mapping[str, NDArray[Any]]
    ) -> "pyarrow.Table":
        pa, columns = self._pa, {}
        for name, values in arrays.items():
            flat = pa.array(values.ravel())
            if name in (*_FEATURES, _ACTION):
                flat = pa.FixedSizeListArray.from_arrays(flat, values.shape[1])
            columns[name] = flat
        return pa.table({**columns, **{name: pa.array(own) for name, own in counters.items()}})

    def _tasks(self, tasks: Mapping[str, int]) -> "pyarrow.Table":
        """Return the table of tasks as pandas writes one whose index is the task."""
        index = "__index_level_0__"
        table = self._pa.table({"task_index": list(tasks.values()), index: list(tasks)})
        column = {"field_name": "task_index", "metadata": None, "name": "task_index"}
        kinds = {"numpy_type": "int64", "pandas_type": "int64"}
        text = {"numpy_type": "object", "pandas_type": "unicode"}
        about = {
            "index_columns": [index],
            "column_indexes": [
                {"field_name": None, "metadata": {"encoding": "UTF-8"}, "name": None, **text}
            ],
            "columns": [
                {**column, **kinds},
                {"field_name": index, "metadata": None, "name": None, **text},
            ],
            "creator": {"library": "pyarrow", "version": self._pa.__version__},
            "pandas_version": "2.0.0",
        }
        return table.replace_schema_metadata({"pandas": json.dumps(about)})

    def _write_table(self, inside: str, table: "pyarrow.Table") -> None:
        stored = io.BytesIO()
        self._pq.write_table(table, stored, compression="snappy")
        self.job.write(inside, stored.getvalue())

    def _write_json(self, inside: str, what: Any) -> None:  # noqa: ANN401  # JSON
        self.job.write(inside, json.dumps(what, indent=4) + "\n")


def _info(order: Sequence[Exported], kept: Row, tasks: int, actions: Sequence[str]) -> Row:
    """Return the description of the data set; `actions` are the names of their numbers."""
    height, width = kept["size"]
    fps = int(kept["fps"]) if float(kept["fps"]).is_integer() else kept["fps"]
    video = {
        "video.height": height,
        "video.width": width,
        "video.codec": "h264",
        "video.pix_fmt": "yuv420p",
        "video.is_depth_map": False,
        "video.fps": fps,
        "video.channels": 3,
        "has_audio": False,
    }
    axes = {"dtype": "video", "names": ["height", "width", "channels"], "info": video}
    vectors = {
        name: {"dtype": "float32", "shape": [len(names)], "names": list(names), "fps": fps}
        for name, names in {**_FEATURES, _ACTION: actions}.items()
    }
    single = {"shape": [1], "names": None, "fps": fps}
    counters = {
        name: {"dtype": "float32" if name == "timestamp" else "int64", **single}
        for name in _COUNTERS
    }
    splits, first = {}, 0
    for split in dict.fromkeys(episode.split for episode in order):
        count = sum(episode.split == split for episode in order)
        splits[split] = f"{first}:{first + count}"
        first += count
    return {
        "codebase_version": "v3.0",
        "robot_type": "drone",
        "total_episodes": len(order),
        "total_frames": sum(episode.frames for episode in order),
        "total_tasks": tasks,
        "chunks_size": _CHUNK,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": fps,
        "splits": splits,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
        "features": {
            CAMERA: {"shape": [height, width, 3], **axes},
            **vectors,
            "next.reward": {"dtype": "float32", **single},
            "next.done": {"dtype": "bool", **single},
            **counters,
        },
    }


def _stats(values: NDArray[Any]) -> Stats:
    """Return the statistics of a feature over the frames of an episode."""
    numbers = values.reshape(len(values), -1).astype(np.float64)
    return {
        "min": numbers.min(axis=0).tolist(),
        "max": numbers.max(axis=0).tolist(),
        "mean": numbers.mean(axis=0).tolist(),
        "std": numbers.std(axis=0).tolist(),
        "count": [len(numbers)],
    }


def _colour_stats(episode: RecordedEpisode) -> Stats:
    """Return the statistics of red, green, blue, 0 to 1, over some pictures, shape (3, 1, 1)."""
    chosen = np.unique(np.linspace(0, len(episode) - 1, _LOOKED_AT).astype(int)).tolist()
    pixels = [episode[number].picture().reshape(-1, 3)[::7] for number in chosen]
    own = _stats(np.concatenate(pixels) / 255.0)
    return {
        kind: [len(chosen)] if kind == "count" else [[[value]] for value in values]
        for kind, values in own.items()
    }


def _all_stats(rows: Sequence[Row]) -> dict[str, Stats]:
    """Return the statistics over all episodes, from those of each."""
    names = [key.split("/")[1] for key in rows[0] if key.startswith("stats/") and "/min" in key]
    return {name: _joined([_own(row, name) for row in rows]) for name in names}


def _own(row: Row, name: str) -> dict[str, NDArray[np.float64]]:
    kinds = ("min", "max", "mean", "std", "count")
    return {kind: np.array(row[f"stats/{name}/{kind}"], np.float64) for kind in kinds}


def _joined(several: Sequence[dict[str, NDArray[np.float64]]]) -> Stats:
    counts = np.array([own["count"][0] for own in several])
    means = np.stack([own["mean"] for own in several])
    squares = np.stack([np.square(own["std"]) + np.square(own["mean"]) for own in several])
    mean = np.average(means, axis=0, weights=counts)
    variance = np.average(squares, axis=0, weights=counts) - np.square(mean)
    return {
        "min": np.min([own["min"] for own in several], axis=0).tolist(),
        "max": np.max([own["max"] for own in several], axis=0).tolist(),
        "mean": mean.tolist(),
        "std": np.sqrt(np.maximum(variance, 0.0)).tolist(),
        "count": [int(counts.sum())],
    }
