"""WebDataset shards: `<split>-000000.tar`, one an episode, with the files of each frame in a row.

Keys are `<episode>_000123` with `.jpg` or `.png`, `.json` (the label), and, if they were recorded,
`.masks.png`, `.classes.png`, `.depth.png`, `.flow.png`. `<split>.json` is the index that
`wids.ShardListDataset` of https://github.com/webdataset/webdataset reads.
"""

import io
import json
import tarfile
from collections.abc import Sequence

from eyas.engine.core.files import atomic_path, read_limited
from eyas.engine.recordings.format import KEPT, Exported, Format, picture_ending
from eyas.engine.recordings.recording import RecordedEpisode

_LARGEST = 1 << 28  # Largest file of one frame [bytes]
_PLANES = ("masks", "classes", "depth", "flow")


class WebDataset(Format):
    """Tar files."""

    needs = frozenset({"jpeg", "labels"})

    def add(self, episode: RecordedEpisode) -> None:
        """Write its shard, whose place among the others is not known yet."""
        planes = [plane for plane in _PLANES if episode.has(plane)]
        ending, path = picture_ending(episode), self.job.folder / KEPT / f"{episode.name}.tar"
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_path(path) as part, tarfile.open(part, "w", format=tarfile.USTAR_FORMAT) as tar:
            for frame in episode:
                key = f"{episode.name}_{frame.number:06d}"
                _put(
                    tar,
                    f"{key}.{ending}",
                    read_limited(episode.picture_file(frame.number), _LARGEST),
                )
                _put(tar, f"{key}.json", json.dumps(frame.label).encode())
                for plane in planes:
                    _put(tar, f"{key}.{plane}.png", read_limited(frame.file(plane), _LARGEST))

    def finish(self, episodes: Sequence[Exported]) -> None:
        """Number the shards, and write the index of each split."""
        for split in dict.fromkeys(episode.split for episode in episodes):
            shards = []
            own = [episode for episode in episodes if episode.split == split]
            for number, episode in enumerate(own):
                shard = f"{split}-{number:06d}.tar"
                self.job.settle(f"{episode.name}.tar", shard)
                shards.append({"url": shard, "nsamples": episode.frames})
            index = {
                "__kind__": "wids-shard-index-v1",
                "wids_version": 1,
                "name": f"{self.job.name}-{split}",
                "shardlist": shards,
            }
            self.job.write(f"{split}.json", json.dumps(index, indent=1) + "\n")


def _put(tar: tarfile.TarFile, name: str, content: bytes) -> None:
    about = tarfile.TarInfo(name)  # without a date or an owner: the same bytes each time
    about.size = len(content)
    tar.addfile(about, io.BytesIO(content))
