"""Draws and writes the frames of a recording, counts them, and keeps checksums of its episodes.

By its checksums an episode that is damaged is known and drawn again. `checksums.sha256` has the
files of all episodes:

    0f3a...  DRONE0/episode0/000000.jpeg

Those of an episode are appended to `.checksums` when it ends; the file is made of them when all
have ended.
"""

import hashlib
import operator
import os
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import NamedTuple, ParamSpec

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError, OutputError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.optics.lens import NO_LENS
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.checksums import CHECKSUMS, GROWING, checksum_lines, read_checksums
from eyas.engine.exports.frame import Frame, RecordedAction
from eyas.engine.exports.writer import EndedEpisode, Episode, Scores, Summary, Writer, joined
from eyas.engine.recordings.rerun import LiveView
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.sim.flights.shares import SMALL
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.video.episode import EpisodeFiles, RecordedPaths, paths_below, read_complete
from eyas.engine.video.folder import VideoFolder

_NEAR = 0.05  # A share that differs by no more from what was asked is reached


@dataclass(slots=True)
class ReachedShares:
    """Numbers of frames, of those that were drawn."""

    frames: int = 0
    in_view: int = 0
    hidden: int = 0
    cut: int = 0
    small: int = 0

    def add(self, frame: Frame) -> None:
        """Count a frame."""
        target = frame.target
        left, top, right, bottom = target.box.tolist()
        pixels = (right - left) * (bottom - top)
        self.frames += 1
        if not pixels:
            return
        self.in_view += 1
        self.hidden += target.visible_fraction <= 0.5
        self.cut += target.truncated(frame.camera) > 0.0
        self.small += pixels < SMALL

    def shares(self) -> dict[str, float]:
        """Return the shares by their settings."""
        names = ("in_view", "hidden", "cut", "small")
        return {name: getattr(self, name) / max(self.frames, 1) for name in names}

    def plus(self, other: "ReachedShares") -> "ReachedShares":
        """Return both together."""
        return ReachedShares(*map(operator.add, astuple(self), astuple(other)))


def missed(reached: ReachedShares, video: VideoConfig) -> Iterator[str]:
    """Yield a line for each share that was asked of camera paths and is not reached."""
    for name, share in reached.shares().items():
        asked = getattr(video, name)
        if reached.frames and asked is not None and abs(share - asked) > _NEAR:
            yield (
                f"note: video.{name}: {asked:.0%} of the frames were asked, the flights came to "
                f"{share:.0%}; other heights, pitches, maps or longer episodes may come nearer"
            )


class Checksums:
    """The checksums of the episodes that have ended. Its methods may be called in any thread."""

    def __init__(self, run: Path, writers: Sequence[Writer]) -> None:
        self._run, self._growing = run, run / GROWING
        self._contents = RecordedPaths(joined(writer.files for writer in writers))
        self._lock = threading.Lock()
        self._known = _read(run / CHECKSUMS) | _read(self._growing)

    def add(self, episode: Path) -> None:
        """Add those of an episode that has ended.

        Raises:
            OutputError: They cannot be written, or a file not be read.
        """
        sums = self._of(episode)
        with self._lock, refusals(self._growing):
            self.replace([episode], sums)
            with self._growing.open("ab", buffering=0) as file:
                # A line that a kill has cut off must not spoil the next one. All at once, as other
                # processes append theirs.
                left = memoryview(b"\n" * bool(file.tell()) + checksum_lines(sums))
                while left:
                    left = left[file.write(left) :]

    def of_episodes(self, episodes: Iterable[Path]) -> dict[str, str]:
        """Return those of some episodes, by the files' names."""
        inside = tuple(self._inside(episode) for episode in episodes)
        return {name: own for name, own in self._known.items() if name.startswith(inside)}

    def replace(self, episodes: Iterable[Path], sums: dict[str, str]) -> None:
        """Replace those of some episodes, which another process has recorded."""
        old = self.of_episodes(episodes)
        self._known = {name: own for name, own in self._known.items() if name not in old} | sums

    def match(self, episode: Path) -> bool:
        """Return whether the files of an episode are those that were written when it ended."""
        known = self.of_episodes([episode])
        return bool(known) and known == self._of(episode)

    def finish(self) -> None:
        """Write all of them in order, so that a recording that was continued is the same.

        Raises:
            OutputError: They cannot be written.
        """
        write_atomic(self._run / CHECKSUMS, checksum_lines(self._known))
        with refusals(self._growing):
            self._growing.unlink(missing_ok=True)

    def _inside(self, episode: Path) -> str:
        return f"{episode.relative_to(self._run).as_posix()}/"

    def _of(self, episode: Path) -> dict[str, str]:
        inside, sums = self._inside(episode), {}
        with refusals(episode):
            for name, path in paths_below(episode):
                if self._contents.in_episode(name) and not path.is_dir():
                    sums[inside + name] = hashlib.sha256(path.read_bytes()).hexdigest()
        return sums


def _read(path: Path) -> dict[str, str]:
    """Return what an earlier run has written; nothing if there was none."""
    try:
        return read_checksums(path)
    except DataFileError:
        return {}


Arguments = ParamSpec("Arguments")

MOST_WAITING = 8  # Most calls that may wait for a thread; it limits the pictures held in memory


class WriterThreads:
    """Runs calls in threads; calls with the same key run one after the other, in order.

    Drawing, video encoding and writing release Python's global lock, so that they use cores that
    others leave idle: with one such core, four pictures of 320 x 240 took 22 ms instead of 31.
    Pillow's JPEG encoder does not release it.
    """

    def __init__(self, count: int) -> None:
        threads = min(count, os.cpu_count() or 1, 8)
        self._threads = [
            ThreadPoolExecutor(1, f"eyas-writer-{number}") for number in range(threads)
        ]
        self._waiting: list[deque[Future[None]]] = [deque() for _ in range(threads)]
        self._failed = [False] * threads

    def submit(
        self,
        key: int,
        call: Callable[Arguments, None],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> None:
        """Run a call in the key's thread; raise the error of an earlier call there."""
        number = key % len(self._threads)
        waiting = self._waiting[number]
        while waiting and (len(waiting) >= MOST_WAITING or waiting[0].done()):
            waiting.popleft().result()
        waiting.append(
            self._threads[number].submit(self._run, number, lambda: call(*args, **kwargs))
        )

    def _run(self, number: int, call: Callable[[], None]) -> None:
        # After a frame has failed, its episode must not be finished as if it were complete.
        if self._failed[number]:
            return
        try:
            call()
        except BaseException:
            self._failed[number] = True
            raise

    def finish(self) -> None:
        """Wait for all calls; raise the error of one that failed."""
        for waiting in self._waiting:
            while waiting:
                waiting.popleft().result()
        self.stop()

    def stop(self) -> None:
        """Wait for all calls, and ignore their errors."""
        for thread in self._threads:
            thread.shutdown(wait=True)


class Share(NamedTuple):
    """Which episodes one of several processes records, such that each has as many."""

    number: int = 0  # Of the process
    processes: int = 1

    def has(self, tracker: int, episode: int) -> bool:
        """Return whether an episode of a tracker is among them."""
        return (tracker + episode) % self.processes == self.number


_ALL = Share()


class RecordedShare(NamedTuple):
    """What another process has recorded."""

    drawn: int  # Frames that were drawn
    reached: list[ReachedShares]  # See `Recorder`
    summaries: dict[tuple[int, int], Summary]  # By tracker and number of the episode
    sums: dict[str, str]  # Checksums by the files' names


@dataclass(slots=True)
class _OpenEpisode:
    """An episode in progress."""

    episode: Episode
    files: EpisodeFiles | None  # None: an earlier run has recorded it, or another process does
    summary: Summary  # Summary of the frames up to now, or of all frames of an earlier run


class Recorder:
    """Records the episodes of all trackers into a folder.

    An episode that an earlier run has recorded completely is kept and not drawn again, if its files
    are what they were.
    """

    episodes: list[list[EndedEpisode]]
    """The ended episodes of each tracker that have frames."""
    drawn: int
    """Frames that were drawn."""
    reached: list[ReachedShares]
    """Shares of the drawn frames of each tracker, by the way they show its target."""

    def __init__(
        self,
        sim: Simulation,
        config: EyasConfig,
        folder: VideoFolder,
        share: Share = _ALL,
        live: LiveView | None = None,  # Shows frames as they are recorded
    ) -> None:
        count = config.video.channels
        self._sim, self._share, self._live = sim, share, live
        self._folder = folder
        self._threads = WriterThreads(count)
        self._checksums = Checksums(folder.path, folder.writers)
        wanted = {output for writer in folder.writers for output in writer.wants}
        self._wanted = wanted = wanted | (live.wants if live is not None else set())
        self._besides = wanted & {"words", "parts", "clean", "cameras", "events", "traffic"}
        self._overlay = config.video.overlay and "rgb" in wanted
        pictures = wanted - self._besides - {"others"}
        self._picture = Picture.create(
            count,
            config.camera.height,
            config.camera.width,
            rgb="rgb" in wanted,
            # A picture needs at least one array of pixels; this one is the fastest.
            depth="depth" in wanted or "others" in wanted or not pictures,
            object_id="object_id" in wanted or "others" in wanted,
            class_id="class_id" in wanted,
            normal="normal" in wanted,
            subject=True,
            actors=sim.actors if "others" in wanted else 0,
        )
        self._open: list[_OpenEpisode | None] = [None] * count
        self._begun: list[EpisodeFiles] = []
        self.episodes = [[] for _ in range(count)]
        self.drawn = 0
        self.reached = [ReachedShares() for _ in range(count)]

    def take(self, due: NDArray[np.int32], action_of: Callable[[int], RecordedAction]) -> None:
        """Record one frame of each of these trackers.

        Args:
            due: Trackers, shape (V,).
            action_of: Returns the action of a tracker in the last step.

        Raises:
            OutputError: This frame or an earlier one could not be written.
        """
        drawn = [tracker for tracker in due.tolist() if self._begin(tracker).files]
        if not drawn:
            return
        picture = self._picture.first(len(drawn))
        overlaid = self._sim.rules if self._overlay else None
        self._sim.view.draw(np.array(drawn, np.int32), picture, overlaid=overlaid)
        around = self._sim.view.around(drawn)
        for view, tracker in enumerate(drawn):
            moment = moment_of(self._sim, tracker, picture, view, self._besides, around[view])
            going, action = self._begin(tracker), action_of(tracker)
            number = going.summary.frames
            frame = frame_of(moment, tracker, picture, view, number, action, self._wanted)
            going.summary = going.summary.plus(frame)
            self.reached[tracker].add(frame)
            assert going.files is not None
            self._threads.submit(tracker, going.files.add, frame)
            if self._live is not None:
                self._live.show(frame, going.episode)
        self.drawn += len(drawn)

    def _begin(self, tracker: int) -> _OpenEpisode:
        """Return the episode of a tracker, after beginning it if needed."""
        going = self._open[tracker]
        if going is None:
            going = self._open[tracker] = self._found_or_new(tracker)
        return going

    def _found_or_new(self, tracker: int) -> _OpenEpisode:
        writers = self._folder.writers
        field = float(self._sim.snapshot.cameras.field_of_view[tracker])
        lens = self._sim.view.lens_of(tracker) or NO_LENS
        number = len(self.episodes[tracker])
        episode = self._folder.episode(tracker, number, field, lens)
        if not self._share.has(tracker, number):
            return _OpenEpisode(episode, None, Summary(0))
        found = read_complete(writers, episode.folder)
        if found is not None and self._checksums.match(episode.folder):
            return _OpenEpisode(episode, None, found)
        files = EpisodeFiles(writers, episode)
        self._begun = [begun for begun in self._begun if not begun.finished] + [files]
        return _OpenEpisode(episode, files, Summary(0, Scores()))

    def end(self, trackers: NDArray[np.bool_]) -> None:
        """End the episodes of the trackers of a mask, shape (N,); those without frames are dropped.

        Raises:
            OutputError: Writing failed.
        """
        for tracker in np.flatnonzero(trackers).tolist():
            going = self._open[tracker]
            if going is not None:
                if going.files is not None:
                    self._threads.submit(tracker, going.files.finish)
                    self._threads.submit(tracker, self._checksums.add, going.episode.folder)
                self.episodes[tracker].append(EndedEpisode(going.episode, going.summary))
            self._open[tracker] = None

    def end_all(self) -> None:
        """End all episodes.

        Raises:
            OutputError: Writing failed.
        """
        self.end(np.ones(len(self._open), np.bool_))
        self._threads.finish()

    def recorded(self) -> RecordedShare:
        """Return what this process has recorded, after all episodes have ended."""
        own = {
            (tracker, number): ended
            for tracker, episodes in enumerate(self.episodes)
            for number, ended in enumerate(episodes)
            if self._share.has(tracker, number)
        }
        sums = self._checksums.of_episodes(ended.episode.folder for ended in own.values())
        summaries = {key: ended.summary for key, ended in own.items()}
        return RecordedShare(self.drawn, self.reached, summaries, sums)

    def join(self, other: RecordedShare) -> None:
        """Take over what another process has recorded."""
        self.drawn += other.drawn
        self.reached = [a.plus(b) for a, b in zip(self.reached, other.reached, strict=True)]
        folders = []
        for (tracker, number), summary in other.summaries.items():
            ended = self.episodes[tracker][number]
            self.episodes[tracker][number] = ended._replace(summary=summary)
            folders.append(ended.episode.folder)
        self._checksums.replace(folders, other.sums)

    def finish(self) -> None:
        """End all episodes, and describe the whole recording.

        Raises:
            OutputError: Writing failed.
        """
        self.end_all()
        for writer in self._folder.writers:
            writer.finish([ended for own in self.episodes for ended in own])
        self._checksums.finish()

    def stop(self) -> None:
        """Stop before the end; every file that exists is complete."""
        self._threads.stop()
        for files in self._begun:
            # Why the recording stops is told, not that its parts lie where nothing can be removed.
            with suppress(OutputError):
                files.abandon()
