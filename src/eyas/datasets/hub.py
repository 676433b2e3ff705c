"""A data set on the Hugging Face hub: its files, and tables of boxes for `load_dataset`."""

import json
import re
from pathlib import Path

from eyas.datasets.card import REPOSITORY_SPLITS
from eyas.datasets.layout import MAKING_FILE
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import PART_SUFFIX, read_limited
from eyas.engine.core.folder_lock import LOCK
from eyas.engine.exports.hub import CARD, HubRepository
from eyas.engine.recordings.format import left_top_width_height, objects_of
from eyas.engine.recordings.recording import DATASET_FILE, Recording, load

METADATA = "metadata.jsonl"
"""Table beside the pictures of a split: what the loader `imagefolder` of `datasets` reads."""
_PICTURES = re.compile(rf"^    path: (parts/({'|'.join(REPOSITORY_SPLITS)})/.*)$", re.MULTILINE)
"""The pictures of a split in the front matter of a card."""


def hub_files(root: Path) -> dict[str, Path | bytes]:
    """Return the files of a finished data set, or their contents, by the path on the hub.

    Raises:
        DataFileError: The folder holds no finished data set, or it cannot be read.
    """
    require_finished(root)
    own = (LOCK, MAKING_FILE)
    files: dict[str, Path | bytes] = {
        path.relative_to(root).as_posix(): path
        for path in sorted(root.rglob("*"))
        if path.is_file() and path.name not in own and not path.name.endswith(PART_SUFFIX)
    }
    files |= {path: table.encode() for path, table in _tables(load(root)).items()}
    text = read_limited(root / CARD, 1 << 24).decode()
    files[CARD] = _PICTURES.sub(rf"    path:\n    - parts/\2/{METADATA}\n    - \1", text).encode()
    return files


def require_finished(root: Path) -> None:
    """Refuse a folder that holds no finished data set.

    Raises:
        DataFileError: It holds none.
    """
    if not (root / DATASET_FILE).is_file():
        raise DataFileError(f"{root}: not a finished data set: it has no {DATASET_FILE}")


def push(root: Path, repository: HubRepository) -> None:
    """Publish a finished data set.

    Raises:
        DataFileError: The folder holds no finished data set, or it cannot be read.
        OutputError: The hub is not reached, or refuses.
    """
    repository.push(hub_files(root), f"Data set {root.resolve().name}, made by Eyas")


def _tables(recording: Recording) -> dict[str, str]:
    """Return tables by path, with a row of JSON for each picture: what is visible in it.

    A box is left, top, width, height [pixels], as in COCO.
    """
    rows: dict[str, list[str]] = {}
    for episode in recording.episodes:
        if not (episode.has("jpeg") or episode.has("png")):
            continue
        for frame in episode:
            seen = list(objects_of(frame.label))
            row = {
                # Below `parts/<split>`: recording, tracker, episode, picture.
                "file_name": "/".join(episode.picture_file(frame.number).parts[-4:]),
                "objects": {
                    "bbox": [left_top_width_height(each.label["visible_box"]) for each in seen],
                    "category": [each.name for each in seen],
                    "track_id": [each.label["id"] for each in seen],
                    "is_target": [each.is_target for each in seen],
                },
                "words": frame.label["target_words"],
            }
            rows.setdefault(episode.split, []).append(json.dumps(row) + "\n")
    return {f"parts/{split}/{METADATA}": "".join(lines) for split, lines in rows.items()}
