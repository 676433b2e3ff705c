"""The camera of one vehicle: MAVLink's camera protocol, and the target that it tracks."""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.state.scene import ACTOR_OBJECT
from eyas.lanes import exact
from eyas.robotics.mavlink.component import Command, Component, Fields, Result
from eyas.robotics.mavlink.gimbal import DEVICE
from eyas.robotics.mavlink.readings import Instant
from eyas.robotics.mavlink.telemetry import degrees_e7

COMPONENT = 100  # Component id of the camera

_IDLE, _ACTIVE, _ERROR = 0, 1, 2
_NONE, _POINT, _RECTANGLE = 0, 1, 2
_IN_STATUS = 4
_STATUSES = ("camera_tracking_image_status", "camera_tracking_geo_status")
_STATUS_RATE = 10.0  # While it tracks, unless someone asks for another rate [Hz]
_SENSOR = 6.0  # Width of the sensor that is told [mm]: what matters is the field of view


class Lens(NamedTuple):
    """A camera's picture."""

    width: int  # [pixels]
    height: int  # [pixels]
    field_of_view: float  # Horizontal [rad]
    rate: float  # Pictures per second [Hz]
    port: int  # UDP port for video; 0 disables it


class LockedSubject(NamedTuple):
    """What is tracked, world frame."""

    position: tuple[float, float, float]  # [m]
    velocity: tuple[float, float, float]  # [m/s]


_CLICKED = 0.03  # Largest distance of a clicked point from its object, as a share of the width


class Sighting(NamedTuple):
    """The target in a picture; shares of its sides, from the left and the top."""

    left: float
    top: float
    right: float
    bottom: float
    share: float  # Share of the object's pixels that are visible


class Sights:
    """Looks through the cameras of a simulation's trackers."""

    def __init__(self, simulation: Simulation) -> None:
        camera = simulation.config.camera
        self._simulation = simulation
        self._size = camera.height, camera.width
        self._measured = Picture.create(1, *self._size, rgb=False, class_id=True, subject=True)
        self._objects = Picture.create(1, *self._size, rgb=False, object_id=True)

    def seen(self, vehicle: int) -> Sighting | None:
        """Return where the target of a vehicle is in its picture; None if no part is visible."""
        one = np.array([vehicle], np.int32)
        self._simulation.view.draw(one, self._measured, DrawStage.RASTERISING)
        return seen_in(self._measured, 0)

    def chosen(self, vehicle: int, box: tuple[float, float, float, float]) -> int | str:
        """Return the actor that covers most of a box, or is nearest to it; why not, if none is.

        Args:
            vehicle: Whose picture it is.
            box: Left, top, right, bottom as shares of the sides.
        """
        one = np.array([vehicle], np.int32)
        self._simulation.view.draw(one, self._objects, DrawStage.RASTERISING)
        assert self._objects.object_id is not None
        actors = self._objects.object_id[0] - ACTOR_OBJECT
        rows, columns = np.nonzero((actors >= 0) & (actors < self._simulation.actors))
        if not len(rows):
            return self._hidden(vehicle, box) or "no vehicle or person in the picture"
        height, width = self._size
        across, down = columns + 0.5, rows + 0.5
        right, left = across - box[2] * width, box[0] * width - across
        low, high = down - box[3] * height, box[1] * height - down
        aside = np.maximum(np.maximum(right, left), 0.0)
        along = np.maximum(np.maximum(low, high), 0.0)
        away = np.sqrt(aside * aside + along * along)
        near = away <= max(float(away.min()), 0.5)
        if float(away.min()) > _CLICKED * width:
            return self._hidden(vehicle, box) or "no vehicle or person there"
        found, count = np.unique(actors[rows[near], columns[near]], return_counts=True)
        return int(found[int(count.argmax())])

    def _hidden(self, vehicle: int, box: tuple[float, float, float, float]) -> str:
        """Return that an actor in a box is hidden; nothing if none is there."""
        height, width = self._size
        measured = Picture.create(
            *(1, height, width), rgb=False, depth=True, subject=True, actors=self._simulation.actors
        )
        self._simulation.view.draw(np.array([vehicle], np.int32), measured)
        assert measured.actor_box is not None
        assert measured.actor_pixels is not None
        extents, pixels = measured.actor_box[0], measured.actor_pixels[0]
        left, top, right, bottom = np.array(box) * (width, height, width, height)
        there = (extents[:, 0] <= right) & (extents[:, 2] >= left)
        there &= (extents[:, 1] <= bottom) & (extents[:, 3] >= top)
        hidden = there & (pixels[:, 0] == 0) & (pixels[:, 1] > 0)
        return "what is there is hidden" if hidden.any() else ""


def seen_in(picture: Picture, view: int) -> Sighting | None:
    """Return where the subject of a view is in its picture; None if no part of it is visible."""
    assert picture.subject_visible_box is not None
    assert picture.subject_pixels is not None
    visible, whole = picture.subject_pixels[view].tolist()
    if not visible:
        return None
    height, width = _size_of(picture)
    left, top, right, bottom = picture.subject_visible_box[view].tolist()
    box = left / width, top / height, right / width, bottom / height
    return Sighting(*box, visible / max(whole, 1))


def _size_of(picture: Picture) -> tuple[int, int]:
    planes: list[NDArray[np.generic] | None] = [picture.rgb, picture.class_id]
    height, width = next(plane for plane in planes if plane is not None).shape[1:3]
    return height, width


class CameraComponent:
    """Answers for the camera, and tells where the target is.

    Attributes:
        tracks: Whether a target is tracked.
        zoom: By how much its field of view is narrowed, from 1.

    Args:
        now: Returns the present instant.
        choose: Makes what is in a box of the picture (left, top, right, bottom, as shares of the
            sides) the target; returns why not, if it cannot.
        subject: Returns the target.
    """

    def __init__(
        self,
        component: Component,
        lens: Lens,
        now: Callable[[], Instant],
        choose: Callable[[tuple[float, float, float, float]], str],
        subject: Callable[[], LockedSubject],
    ) -> None:
        self.tracks, self.zoom = False, 1.0
        self._component, self._lens, self._now = component, lens, now
        self._choose, self._subject = choose, subject
        self._mode, self._seen = _NONE, None
        component.producers.update(
            {
                "heartbeat": lambda: (self._heartbeat(),),
                "camera_information": lambda: (self._information(),),
                "camera_settings": lambda: (self._settings(),),
                "camera_capture_status": lambda: (self._capture_status(),),
                "camera_fov_status": lambda: (self._fov_status(),),
                "storage_information": lambda: (self._storage(),),
                "video_stream_information": self._streams,
                "video_stream_status": self._stream_states,
                "camera_tracking_image_status": lambda: (self._image_status(),),
                "camera_tracking_geo_status": self._geo_status,
            }
        )
        component.stream("heartbeat", 1.0)
        asked = {
            "REQUEST_CAMERA_INFORMATION": "camera_information",
            "REQUEST_CAMERA_SETTINGS": "camera_settings",
            "REQUEST_STORAGE_INFORMATION": "storage_information",
            "REQUEST_CAMERA_CAPTURE_STATUS": "camera_capture_status",
            "REQUEST_VIDEO_STREAM_INFORMATION": "video_stream_information",
            "REQUEST_VIDEO_STREAM_STATUS": "video_stream_status",
        }
        component.answers.update({old: self._telling(new) for old, new in asked.items()})
        component.answers.update(
            {
                "CAMERA_TRACK_POINT": self._track_point,
                "CAMERA_TRACK_RECTANGLE": self._track_rectangle,
                "CAMERA_STOP_TRACKING": self._stop,
                "SET_CAMERA_ZOOM": self._set_zoom,
                "VIDEO_START_STREAMING": self._has_video,
                "VIDEO_STOP_STREAMING": self._has_video,
            }
        )

    _seen: Sighting | None

    def see(self, seen: Sighting | None) -> None:
        """Take where the target is in the newest picture."""
        self._seen = seen

    @property
    def field_of_view(self) -> float:
        """Horizontal, now [rad]."""
        return 2.0 * float(exact.atan(exact.tan(0.5 * self._lens.field_of_view) / self.zoom))

    def _telling(self, message: str) -> Callable[[Command], Result]:
        def answer(command: Command) -> Result:
            self._component.tell(message)
            return Result.ACCEPTED

        return answer

    def _track_point(self, command: Command) -> Result:
        x, y, _ = command.p[:3]
        return self._track((x, y, x, y), _POINT)

    def _track_rectangle(self, command: Command) -> Result:
        left, top, right, bottom = command.p[:4]
        return self._track((left, top, right, bottom), _RECTANGLE)

    def _track(self, box: tuple[float, float, float, float], mode: int) -> Result:
        if not all(0.0 <= part <= 1.0 for part in box) or box[0] > box[2] or box[1] > box[3]:
            return self._refused(Result.DENIED, "outside the picture: 0 to 1 in x, y")
        if why := self._choose(box):
            return self._refused(Result.FAILED, why)
        self.tracks, self._mode = True, mode
        for message in _STATUSES:
            self._component.begin_stream(message, _STATUS_RATE)
        return Result.ACCEPTED

    def _refused(self, result: Result, why: str) -> Result:
        """Return a result, after a text for the ground station that says why."""
        warning = self._component.names.MAV_SEVERITY_WARNING
        text = f"Not tracked: {why}".encode()[:50]  # a message has no more room
        self._component.send("statustext", severity=warning, text=text)
        return result

    def _stop(self, command: Command) -> Result:
        self.tracks, self._mode, self._seen = False, _NONE, None
        self._component.tell("camera_tracking_image_status")
        for message in _STATUSES:
            self._component.end_stream(message)
        return Result.ACCEPTED

    def _set_zoom(self, command: Command) -> Result:
        """Zoom to a share of the whole range, which is from 1 to 4 times."""
        kind, value = command.p[:2]
        if kind != 2 or not 0.0 <= value <= 100.0:
            return Result.DENIED
        self.zoom = 1.0 + 3.0 * value / 100.0
        return Result.ACCEPTED

    def _has_video(self, command: Command) -> Result:
        """Answer whoever starts or stops the video, which always goes on."""
        return Result.ACCEPTED if self._lens.port else Result.DENIED

    def _heartbeat(self) -> Fields:
        n = self._component.names
        return {
            **{"type": n.MAV_TYPE_CAMERA, "autopilot": n.MAV_AUTOPILOT_INVALID, "base_mode": 0},
            **{"custom_mode": 0, "system_status": n.MAV_STATE_ACTIVE, "mavlink_version": 3},
        }

    def _information(self) -> Fields:
        n, lens = self._component.names, self._lens
        can = ("HAS_BASIC_ZOOM", "HAS_TRACKING_POINT", "HAS_TRACKING_RECTANGLE")
        flags = sum(getattr(n, f"CAMERA_CAP_FLAGS_{what}") for what in can)
        flags |= n.CAMERA_CAP_FLAGS_HAS_TRACKING_GEO_STATUS
        flags |= n.CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM if lens.port else 0
        focal = 0.5 * _SENSOR / float(exact.tan(0.5 * lens.field_of_view))
        return {
            **{"time_boot_ms": self._now().milliseconds, "vendor_name": _padded("Eyas")},
            **{"model_name": _padded("camera"), "firmware_version": 1, "focal_length": focal},
            **{"sensor_size_h": _SENSOR, "sensor_size_v": _SENSOR * lens.height / lens.width},
            **{"resolution_h": lens.width, "resolution_v": lens.height, "lens_id": 0},
            **{"flags": flags, "cam_definition_version": 0, "cam_definition_uri": b""},
            "gimbal_device_id": DEVICE,
        }

    def _settings(self) -> Fields:
        zoom = 100.0 * (self.zoom - 1.0) / 3.0
        at = {"time_boot_ms": self._now().milliseconds}
        return {**at, "mode_id": 1, "zoomLevel": zoom, "focusLevel": math.nan}

    def _capture_status(self) -> Fields:
        return {
            **{"time_boot_ms": self._now().milliseconds, "image_status": 0, "video_status": 0},
            **{"image_interval": 0.0, "recording_time_ms": 0, "available_capacity": 0.0},
            "image_count": 0,
        }

    def _storage(self) -> Fields:
        sizes = ("total_capacity", "used_capacity", "available_capacity")
        return {
            **{"time_boot_ms": self._now().milliseconds, "storage_id": 1, "storage_count": 0},
            **{"status": 0, **dict.fromkeys(sizes, 0.0), "read_speed": 0.0, "write_speed": 0.0},
        }

    def _streams(self) -> Iterable[Fields]:
        lens, n = self._lens, self._component.names
        if lens.port:
            text = {"name": b"Eyas", "uri": str(lens.port).encode()}
            kind = {"count": 1, "type": n.VIDEO_STREAM_TYPE_RTPUDP}
            yield {**self._stream(), **kind, **text, "encoding": n.VIDEO_STREAM_ENCODING_H264}

    def _stream_states(self) -> Iterable[Fields]:
        if self._lens.port:
            yield self._stream()

    def _stream(self) -> Fields:
        lens = self._lens
        return {
            **{"stream_id": 1, "flags": 1, "framerate": lens.rate, "resolution_h": lens.width},
            **{"resolution_v": lens.height, "bitrate": 0, "rotation": 0},
            "hfov": round(math.degrees(self.field_of_view)),
        }

    def _fov_status(self) -> Fields:
        at, lens = self._now(), self._lens
        place, _ = at.camera()
        latitude, longitude, altitude = at.global_of(tuple(place.tolist()))
        ratio = exact.tan(0.5 * self.field_of_view) * lens.height / lens.width
        unknown = 2**31 - 1
        return {
            **{"time_boot_ms": at.milliseconds, "lat_camera": degrees_e7(latitude)},
            **{"lon_camera": degrees_e7(longitude), "alt_camera": round(altitude * 1e3)},
            **{"lat_image": unknown, "lon_image": unknown, "alt_image": unknown},
            **{"q": [math.nan] * 4, "hfov": math.degrees(self.field_of_view)},
            "vfov": math.degrees(2.0 * float(exact.atan(ratio))),
        }

    def _image_status(self) -> Fields:
        """Position of the target in the picture; an error while nothing of it can be seen."""
        seen, state = self._seen, _IDLE
        if self.tracks:
            state = _ERROR if seen is None else _ACTIVE
        box = [math.nan] * 4 if seen is None or not self.tracks else list(seen[:4])
        corners = ("rec_top_x", "rec_top_y", "rec_bottom_x", "rec_bottom_y")
        return {
            **{"tracking_status": state, "tracking_mode": self._mode, "target_data": _IN_STATUS},
            **{"point_x": 0.5 * (box[0] + box[2]), "point_y": 0.5 * (box[1] + box[3])},
            **{"radius": math.nan, **dict(zip(corners, box, strict=True))},
        }

    def _geo_status(self) -> Iterable[Fields]:
        """Position of the target on the earth, also while nothing of it can be seen."""
        if not self.tracks:
            return
        at, subject = self._now(), self._subject()
        latitude, longitude, altitude = at.global_of(subject.position)
        east, north, up = subject.velocity
        away = [to - here for to, here in zip(subject.position, at.body.position, strict=True)]
        flat = float(exact.hypot(away[0], away[1]))
        unknown = dict.fromkeys(("h_acc", "v_acc", "vel_acc", "hdg_acc"), math.nan)
        yield {
            **{"tracking_status": _ERROR if self._seen is None else _ACTIVE, **unknown},
            **{"lat": degrees_e7(latitude), "lon": degrees_e7(longitude), "alt": altitude},
            **{"vel_n": north, "vel_e": east, "vel_d": -up},
            **{"dist": float(exact.hypot(flat, away[2]))},
            "hdg": float(exact.atan2(away[0], away[1])) % (2.0 * math.pi),
        }


def _padded(text: str) -> list[int]:
    return list(text.encode().ljust(32, b"\0"))
