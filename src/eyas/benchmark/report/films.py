"""Films of the worst, the median and the best flight of an evaluation."""

import logging
from collections.abc import Container, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.episodes.episode_batch import EpisodeBatch
from eyas.benchmark.flight.meter import LOOK, Meter
from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.plan import EvaluationPlan, batches
from eyas.benchmark.records.record import EpisodeRecord
from eyas.engine.core.files import refusals
from eyas.engine.exports.mp4 import Mp4Episode
from eyas.engine.state.draw import Picture

FOLDER = "videos"
_LOG = logging.getLogger("eyas")
_SIZE = 480, 640  # Height and width of the pictures


def chosen_flights(records: Sequence[EpisodeRecord]) -> dict[str, EpisodeRecord]:
    """Return the flights with the least, the median and the largest sum of rewards, by name."""
    ranked = sorted(records, key=lambda record: (record.cr, record.name))
    return {"worst": ranked[0], "median": ranked[len(ranked) // 2], "best": ranked[-1]}


def film(
    folder: Path,
    plan: EvaluationPlan,
    records: Sequence[EpisodeRecord],
    wanted: Container[str] = ("worst", "median", "best"),
) -> None:
    """Write `videos/worst.mp4`, `median.mp4` and `best.mp4`, or only those that are wanted.

    The batches of these flights are flown again whole, so that each is the one of its record.

    Raises:
        OutputError: A file cannot be written.
    """
    videos = folder / FOLDER
    with refusals(videos):
        videos.mkdir(exist_ok=True)
    chosen = {name: one for name, one in chosen_flights(records).items() if name in wanted}
    for part in batches(plan):
        rows = {
            name: row
            for row, episode in enumerate(part)
            for name, record in chosen.items()
            if record.name == episode.name
        }
        if rows:
            again = _filmed(videos, plan, part, rows)
            for name in rows:
                if again[chosen[name].name] != chosen[name]:
                    _LOG.warning("%s.mp4: the policy has flown differently than before", name)


def _filmed(
    videos: Path, plan: EvaluationPlan, part: list[EpisodeSpec], rows: Mapping[str, int]
) -> dict[str, EpisodeRecord]:
    """Fly a batch, film some rows of it, and return the records by name."""
    with ExitStack() as unfinished:
        cameras = []
        for name, row in rows.items():
            cameras.append(_Camera(videos / f"{name}.mp4", row, plan))
            unfinished.callback(cameras[-1].abandon)
        flown = fly_batch(plan, part, watcher=lambda *seen: _shoot(cameras, *seen))
        again = {record.name: record for ended in flown for record in ended}
        for camera in cameras:
            camera.finish()
        unfinished.pop_all()
    return again


class _Camera:
    """Films one flight of a batch, with the overlay."""

    def __init__(self, path: Path, row: int, plan: EvaluationPlan) -> None:
        self._row, self._steps = row, 0
        self._file = Mp4Episode(path, *_SIZE, 1.0 / (plan.rules.period * LOOK))
        self._picture = Picture.create(1, *_SIZE)

    def shoot(self, batch: EpisodeBatch, meter: Meter) -> None:
        """Add the picture of a control step, if it is one's turn."""
        flown = int(meter.length[self._row])
        if flown == self._steps or flown % LOOK:
            return
        self._steps = flown
        for group in batch.groups:
            place = np.flatnonzero(group.rows == self._row).astype(np.int32)
            if len(place):
                group.simulation.draw(place, self._picture, overlay=True)
        assert self._picture.rgb is not None
        self._file.add_picture(self._picture.rgb[0])

    def finish(self) -> None:
        """Write what remains."""
        self._file.finish()

    def abandon(self) -> None:
        """Delete the unfinished film."""
        self._file.abandon()


def _shoot(cameras: Sequence[_Camera], batch: EpisodeBatch, meter: Meter) -> None:
    for camera in cameras:
        camera.shoot(batch, meter)
