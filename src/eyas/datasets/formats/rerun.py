"""Rerun: `<split>/<episode>.rrd`, with pictures, camera, boxes in the picture and in the world.

https://rerun.io. Rerun numbers what it stores by the clock, so that the bytes of two exports
differ, not what they hold.
"""

from eyas.engine.core.files import read_limited
from eyas.engine.recordings.format import ExportJob, Format, split_of
from eyas.engine.recordings.recording import RecordedEpisode
from eyas.engine.recordings.rerun import RerunFrames, rerun_sdk


class Rerun(Format):
    """One file an episode.

    Raises:
        MissingExtraError: The Rerun SDK is not installed.
    """

    needs = frozenset({"jpeg", "labels"})

    def __init__(self, job: ExportJob) -> None:
        self.job, self._rr = job, rerun_sdk("the format 'rerun'")

    def add(self, episode: RecordedEpisode) -> None:
        """Write its file."""
        stream = self._rr.RecordingStream(
            "eyas", recording_id=f"{self.job.name}-{episode.name}", send_properties=False
        )
        # In memory: on a full disk Rerun's own thread, which writes, may never end.
        stored = stream.memory_recording()
        frames = RerunFrames(self._rr, stream)
        for frame in episode:
            label = frame.label
            stream.set_time("time", duration=label["episode_time"])
            stream.set_time("frame", sequence=frame.number)
            picture = read_limited(episode.picture_file(frame.number), 1 << 28)
            frames.log(label, picture, f"image/{episode.picture_kind}")
        stream.flush()
        content = stored.drain_as_bytes()
        stream.disconnect()
        self.job.write(f"{split_of(episode)}/{episode.name}.rrd", content)
