"""Rerun: `<split>/<episode>.rrd`, with pictures, camera, boxes in the picture and in the world.

https://rerun.io. Rerun numbers what it stores by the clock, so that the bytes of two exports
differ, not what they hold.
"""

from typing import Any

import numpy as np

from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.files import read_limited
from eyas.engine.exports.boxes import box_of, camera_pose, quaternion_of
from eyas.engine.recordings.format import ExportJob, Format, objects_of, split_of
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame

_TARGET, _OTHER = (255, 140, 0), (90, 170, 255)  # Colours of boxes


class Rerun(Format):
    """One file an episode.

    Raises:
        MissingExtraError: The Rerun SDK is not installed.
    """

    needs = frozenset({"jpeg", "labels"})

    def __init__(self, job: ExportJob) -> None:
        try:
            import rerun
        except ImportError as error:
            raise MissingExtraError("the format 'rerun'", "exports") from error
        self.job, self._rr = job, rerun

    def add(self, episode: RecordedEpisode) -> None:
        """Write its file."""
        stream = self._rr.RecordingStream(
            "eyas", recording_id=f"{self.job.name}-{episode.name}", send_properties=False
        )
        # In memory: on a full disk Rerun's own thread, which writes, may never end.
        stored = stream.memory_recording()
        world = self._rr.ViewCoordinates.RIGHT_HAND_Z_UP
        stream.log("world", world, static=True)
        for frame in episode:
            self._log(stream, frame)
        stream.flush()
        content = stored.drain_as_bytes()
        stream.disconnect()
        self.job.write(f"{split_of(episode)}/{episode.name}.rrd", content)

    def _log(self, stream: Any, frame: RecordedFrame) -> None:  # noqa: ANN401  # rerun's
        rr, label = self._rr, frame.label
        stream.set_time("time", duration=label["episode_time"])
        stream.set_time("frame", sequence=frame.number)
        position, rotation = camera_pose(label)
        stream.log("world/camera", rr.Transform3D(translation=position, mat3x3=rotation))
        size = [label["width"], label["height"]]
        lens = rr.Pinhole(image_from_camera=np.array(label["intrinsics"]), resolution=size)
        stream.log("world/camera/image", lens)
        if "distortion_model" in label:
            bends = {key: label[key] for key in ("distortion_model", "distortion")}
            stream.log("world/camera/image", rr.AnyValues(**bends))
        file = frame.episode.picture_file(frame.number)
        kind = f"image/{frame.episode.picture_kind}"
        picture = rr.EncodedImage(contents=read_limited(file, 1 << 28), media_type=kind)
        stream.log("world/camera/image", picture)
        seen = list(objects_of(label))
        colours = [_TARGET if each.is_target else _OTHER for each in seen]
        words = [each.label["words"] for each in seen]
        plane = np.array([each.label["visible_box"] for each in seen], np.float32).reshape(-1, 4)
        flat = rr.Boxes2D(
            array=plane, array_format=rr.Box2DFormat.XYXY, labels=words, colors=colours
        )
        stream.log("world/camera/image/boxes", flat)
        boxes = [box_of(each.label["corners"]) for each in seen]
        solid = rr.Boxes3D(
            centers=[box.centre for box in boxes],
            sizes=[box.size for box in boxes],
            quaternions=[_xyzw(quaternion_of(box.rotation)) for box in boxes],
            labels=words,
            colors=colours,
        )
        stream.log("world/boxes", solid)
        stream.log("reward", rr.Scalars(np.nan if label["reward"] is None else label["reward"]))
        stream.log("visible_fraction", rr.Scalars(label["visible_fraction"]))


def _xyzw(quaternion: tuple[float, float, float, float]) -> list[float]:
    w, x, y, z = quaternion
    return [x, y, z, w]
