"""Rerun (https://rerun.io): frames as its viewer shows them, in files and while they are flown."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, ClassVar

import numpy as np

from eyas.engine.core.addresses import Address, parsed_address
from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.core.errors import MissingExtraError, OutputError
from eyas.engine.exports.boxes import box_of, camera_pose, quaternion_of
from eyas.engine.exports.frame import Frame, Output
from eyas.engine.exports.label import Label, label_of
from eyas.engine.exports.writer import Episode
from eyas.engine.recordings.format import objects_of
from eyas.engine.terminal.screen import has_screen
from eyas.engine.terminal.stderr import say

_TARGET, _OTHER = (255, 140, 0), (90, 170, 255)  # Colours of boxes
_OWN: Address = ("127.0.0.1", 9876)  # Where a viewer listens that nobody has placed elsewhere
_START = 30.0  # Longest time until a new viewer listens [s]
_SETTLE = 0.5  # Time after which one that cannot open its window has ended [s]
_LOOK = 2.0  # Time from one look at whether the viewer takes frames to the next [s]
_LAST = 5.0  # Longest time for the last frames, and for those of a look [s]
_QUALITY = 80  # JPEG quality of pictures that are shown at once


def rerun_sdk(purpose: str) -> Any:  # noqa: ANN401  # a module without types
    """Return the module `rerun`.

    Raises:
        MissingExtraError: It is not installed.
    """
    os.environ.setdefault("RUST_LOG", "off")  # its own lines beside ours, in several colours
    try:
        import rerun
    except ImportError as error:
        raise MissingExtraError(purpose, "exports") from error
    return rerun


class RerunFrames:
    """Logs frames to a stream of Rerun: picture, camera, boxes in picture and world, reward.

    Args:
        rr: The module `rerun`.
        stream: A `rerun.RecordingStream`; its times are set by the caller.
    """

    def __init__(self, rr: Any, stream: Any) -> None:  # noqa: ANN401  # without types
        self._rr, self._stream = rr, stream
        stream.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)

    def log(self, label: Label, picture: bytes, kind: str, whose: str = "") -> None:
        """Log a frame.

        Args:
            label: Its label.
            picture: Its picture, as a file.
            kind: The kind of that file, `image/jpeg` or the like.
            whose: Prefix of names, `DRONE0/`, where several trackers are in one stream.
        """
        rr, stream = self._rr, self._stream
        camera, image = f"world/{whose}camera", f"world/{whose}camera/image"
        position, rotation = camera_pose(label)
        stream.log(camera, rr.Transform3D(translation=position, mat3x3=rotation))
        size = [label["width"], label["height"]]
        stream.log(
            image, rr.Pinhole(image_from_camera=np.array(label["intrinsics"]), resolution=size)
        )
        if "distortion_model" in label:
            bends = {key: label[key] for key in ("distortion_model", "distortion")}
            stream.log(image, rr.AnyValues(**bends))
        stream.log(image, rr.EncodedImage(contents=picture, media_type=kind))
        seen = list(objects_of(label))
        colours = [_TARGET if each.is_target else _OTHER for each in seen]
        words = [each.label["words"] for each in seen]
        plane = np.array([each.label["visible_box"] for each in seen], np.float32).reshape(-1, 4)
        flat = rr.Boxes2D(
            array=plane, array_format=rr.Box2DFormat.XYXY, labels=words, colors=colours
        )
        stream.log(f"{image}/boxes", flat)
        boxes = [box_of(each.label["corners"]) for each in seen]
        solid = rr.Boxes3D(
            centers=[box.centre for box in boxes],
            sizes=[box.size for box in boxes],
            quaternions=[_xyzw(quaternion_of(box.rotation)) for box in boxes],
            labels=words,
            colors=colours,
        )
        stream.log(f"world/{whose}boxes", solid)
        reward = np.nan if label["reward"] is None else label["reward"]
        stream.log(f"{whose}reward", rr.Scalars(reward))
        stream.log(f"{whose}visible_fraction", rr.Scalars(label["visible_fraction"]))


def _xyzw(quaternion: tuple[float, float, float, float]) -> list[float]:
    w, x, y, z = quaternion
    return [x, y, z, w]


class LiveView:
    """A viewer of Rerun that shows frames as they are flown.

    What is flown outlives it: once the viewer is gone, or no longer takes frames, a line says so,
    and no more are sent.

    Args:
        at: `HOST:PORT` of a viewer or server that listens; None: one is started on this machine,
            unless one listens on Rerun's own port.

    Raises:
        MissingExtraError: Rerun is not installed.
        ConfigError: The address is of another form.
        OutputError: No viewer listens there, or none can be started.
    """

    wants: ClassVar[frozenset[Output]] = frozenset({"rgb", "others", "words"})
    """Fields of frames that it shows, see `Writer.wants`."""

    def __init__(self, at: str | None = None) -> None:
        rr = rerun_sdk("--rerun")
        self._address = _OWN if at is None else parsed_address(at, "--rerun-at")
        if at is None:
            _start_viewer()
        elif why := _unreachable(self._address):
            raise OutputError(
                f"--rerun-at: no viewer listens on {at} ({why}); start one there by 'rerun', or "
                "one on this machine by --rerun"
            )
        host, port = self._address
        rr.unregister_shutdown()  # which would wait for a viewer that hangs
        self._stream = rr.RecordingStream("eyas", send_properties=False)
        place = f"[{host}]" if ":" in host else host
        self._stream.connect_grpc(f"rerun+http://{place}:{port}/proxy")
        self._frames = RerunFrames(rr, self._stream)
        self._count, self._latest, self._before = 0, 0.0, 0.0
        self._there, self._looked = True, time.monotonic()

    @property
    def place(self) -> str:
        """Where the viewer listens, `HOST:PORT`."""
        host, port = self._address
        return f"{host}:{port}"

    def show(self, frame: Frame, episode: Episode) -> None:
        """Show a frame that has the fields of `wants`."""
        if not self._takes_frames():
            return
        assert frame.rgb is not None
        if frame.time < self._latest:  # another world has begun
            self._before += self._latest
        self._latest = frame.time
        self._stream.set_time("time", duration=self._before + frame.time)
        self._stream.set_time("frame", sequence=self._count)
        self._count += 1
        picture = jpeg_bytes(frame.rgb, _QUALITY)
        self._frames.log(label_of(frame, episode), picture, "image/jpeg", f"{episode.tracker}/")

    def close(self) -> None:
        """Send what has not been sent, if the viewer takes it soon."""
        ending = threading.Thread(target=self._stream.disconnect, daemon=True)
        ending.start()
        ending.join(_LAST)

    def _takes_frames(self) -> bool:
        """Return whether the viewer took frames at the last look; look again from time to time."""
        if self._there and time.monotonic() - self._looked > _LOOK:
            try:
                self._stream.flush(timeout_sec=_LAST)
            except Exception:  # Rerun's own kinds
                self._there = False
                say(f"note: Rerun's viewer at {self.place} takes no more frames; flying goes on")
            self._looked = time.monotonic()
        return self._there


def _unreachable(address: Address) -> str:
    """Return why nothing listens at an address; nothing if something does."""
    try:
        socket.create_connection(address, timeout=1.0).close()
    except (OSError, UnicodeError) as error:
        return str(getattr(error, "strerror", None) or error)
    return ""


def _start_viewer() -> None:
    """Start a viewer on this machine that outlives this program, unless one listens there.

    Raises:
        OutputError: There is no screen, or it ends at once.
    """
    if not _unreachable(_OWN):
        return
    why = "" if has_screen() else "there is no screen"
    why = why or _started()
    if why:
        raise OutputError(
            f"--rerun: Rerun's viewer does not start here ({why}); start 'rerun' on a machine with "
            "a screen and name it by --rerun-at HOST:PORT"
        )


def _started() -> str:
    """Start a viewer and wait until it listens; return why it has ended, if it has."""
    place = ["--bind", _OWN[0], "--port", str(_OWN[1])]  # Rerun's default is all networks
    command = [sys.executable, "-m", "rerun", *place, "--expect-data-soon"]
    with tempfile.TemporaryFile() as output:
        viewer = subprocess.Popen(
            command, stdout=output, stderr=output, stdin=subprocess.DEVNULL, start_new_session=True
        )
        until = time.monotonic() + _START
        while viewer.poll() is None and _unreachable(_OWN):
            if time.monotonic() > until:
                _stop(viewer)
            time.sleep(0.05)
        with suppress(subprocess.TimeoutExpired):
            viewer.wait(_SETTLE)
        if viewer.poll() is None:
            viewer.returncode = 0  # it goes on without us, and no warning says so
            return ""
        output.seek(0)
        return output.read().decode(errors="replace").strip().rpartition(": ")[2] or "no word"


def _stop(viewer: "subprocess.Popen[bytes]") -> None:
    """Stop a viewer and its program, which is a child of it; on Windows only the former."""
    if hasattr(os, "killpg"):
        os.killpg(viewer.pid, signal.SIGTERM)
    else:
        viewer.kill()


@contextmanager
def live_view(
    *,
    wanted: bool,  # Whether it was asked for without an address
    at: str | None,  # The address that was given, see `LiveView`
) -> Iterator[LiveView | None]:
    """Yield the viewer that a user has asked for, if any, as long as something flies.

    Raises:
        EyasError: See `LiveView`.
    """
    if not wanted and at is None:
        yield None
        return
    live = LiveView(at)
    try:
        yield live
    finally:
        live.close()
