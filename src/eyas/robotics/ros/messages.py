"""The messages of ROS 2 that tell a frame. Topics, frames and signs are in docs/ros.md."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.exports.frame import Frame, Subject
from eyas.engine.exports.writer import Run
from eyas.engine.sensors.config import ReadingConfig
from eyas.engine.sensors.lidar import CAR_MOUNT, MOUNT
from eyas.engine.sensors.mount import turn_of
from eyas.engine.sensors.table import further_sensors
from eyas.engine.trackers.config import TrackerKind
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.place import projection_of
from eyas.engine.world.projection import Projection
from eyas.robotics.ros.geometry import (
    OPTICAL,
    STILL,
    Pose,
    camera_on_body,
    optical_matrix,
    picture_box,
    pose_of_body,
    pose_of_subject,
)

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

Floats = NDArray[np.float64]
Message = Any  # A message, of a class that `rosbags` makes of the text of its type

TOPICS = {
    "/clock": "rosgraph_msgs/msg/Clock",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/odom": "nav_msgs/msg/Odometry",
    "/imu/data": "sensor_msgs/msg/Imu",
    "/gps/fix": "sensor_msgs/msg/NavSatFix",
    "/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage",
    "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/scan": "sensor_msgs/msg/LaserScan",
    "/cmd_vel": "geometry_msgs/msg/TwistStamped",
    "/detections_2d": "vision_msgs/msg/Detection2DArray",
    "/detections_3d": "vision_msgs/msg/Detection3DArray",
    "/target/detections_2d": "vision_msgs/msg/Detection2DArray",
    "/target/odom": "nav_msgs/msg/Odometry",
}
"""The topics of every recording, and the types of their messages."""


class _Quantity(NamedTuple):
    """The message for numbers in a unit."""

    type: str
    field: str
    width: int
    scale: float  # What ROS has for 1 of the unit


_QUANTITIES = {
    "T": _Quantity("sensor_msgs/msg/MagneticField", "magnetic_field", 3, 1.0),
    "gauss": _Quantity("sensor_msgs/msg/MagneticField", "magnetic_field", 3, 1e-4),
    "Pa": _Quantity("sensor_msgs/msg/FluidPressure", "fluid_pressure", 1, 1.0),
    "hPa": _Quantity("sensor_msgs/msg/FluidPressure", "fluid_pressure", 1, 100.0),
    "°C": _Quantity("sensor_msgs/msg/Temperature", "temperature", 1, 1.0),
    "lx": _Quantity("sensor_msgs/msg/Illuminance", "illuminance", 1, 1.0),
}
"""Messages of further sensors by `Sensor.unit`."""

NOWHERE = Projection(longitude=8.545594, latitude=47.397742)
"""Origin of maps that lie nowhere: the usual home of PX4's simulators, in Zurich."""

_POSITION, _FELT, _TURNING, _ATTITUDE = slice(0, 3), slice(6, 9), slice(9, 12), slice(12, 16)
"""Columns of `Frame.sensors`."""

_GPS, _UNKNOWN, _DIAGONAL_KNOWN = 1, 0, 2
"""`NavSatStatus.SERVICE_GPS`, `NavSatFix.COVARIANCE_TYPE_...`."""

_EXACTLY, _NOT_RECTIFIED = np.zeros(36), np.eye(3).ravel()
"""The covariance of what is true; the rectification of cameras that have none."""

_PER_SECOND = float(PHYSICS_RATE)


def nanoseconds(frame: Frame) -> int:
    """Return the simulated time of a frame since the start of the run [ns]."""
    return round(frame.time * PHYSICS_RATE) * (10**9 // PHYSICS_RATE)


class _Stamp(NamedTuple):
    """The time of a message in the words of ROS."""

    seconds: int
    nanoseconds: int


class Messages:
    """Makes the messages of the frames of a recording.

    Attributes:
        topics: All topics and the types of their messages: those of further sensors, for which
            there is a message, have the sensors' names.

    Args:
        types: The types of messages, see `message_types`.
    """

    def __init__(self, types: "Typestore", run: Run) -> None:
        self._types, self._quality = types.types, run.jpeg_quality
        config = run.config
        self._lidar, errors = config.lidar, config.sensors
        self._turned, self._turning = _covariance(errors.imu), _covariance(errors.gyroscope)
        self._felt = _covariance(errors.accelerometer)
        self._placed = _covariance(errors.gps_position)
        self._further: dict[str, tuple[_Quantity, str, Floats]] = {}
        for fitted in further_sensors(errors):
            sensor, quantity = fitted.sensor, _QUANTITIES.get(fitted.sensor.unit)
            if quantity and len(sensor.parts) == 1 and sensor.width == quantity.width:
                covariance = quantity.scale * quantity.scale * _covariance(fitted.errors)
                self._further[f"/{sensor.name}"] = quantity, min(sensor.parts), covariance
        self.topics = TOPICS | {name: each[0].type for name, each in self._further.items()}
        car = config.tracker.kind is TrackerKind.CAR
        mount = config.lidar.mount or (CAR_MOUNT if car else MOUNT)
        self._laser = Pose(np.array([mount.x, mount.y, mount.z]), turn_of(mount))
        self._projection = projection_of(MAPS.get(config.world.map)) or NOWHERE

    def of(self, frame: Frame) -> Iterator[tuple[str, Message]]:
        """Yield the messages of a frame with their topics, all of the time of the frame."""
        time = nanoseconds(frame)
        stamp = _Stamp(time // 10**9, time % 10**9)
        body, target = pose_of_body(frame.tracker), pose_of_subject(frame.target)[0]
        moving = [
            ("odom", "base_link", body),
            ("base_link", "camera_link", camera_on_body(frame.camera, body)),
            ("map", "target", target),
        ]
        yield "/clock", self._make("rosgraph_msgs/msg/Clock", clock=self._time(stamp))
        if frame.number == 0:
            yield "/tf_static", self._transforms(stamp, self._fixed())
        yield "/tf", self._transforms(stamp, moving)
        yield "/odom", self._own_odometry(frame, stamp, body)
        yield from self._measured(frame, stamp)
        for topic, (quantity, part, covariance) in self._further.items():
            value = quantity.scale * frame.signals[part]
            yield topic, self._reading(quantity, stamp, value, covariance)
        yield from self._pictured(frame, stamp)
        if frame.lidar is not None:
            yield "/scan", self._scan(frame.lidar, stamp)
        if frame.action.command is not None:
            yield "/cmd_vel", self._command(frame.action.command, stamp)
        yield from self._detected(frame, stamp)
        yield "/target/odom", self._target_odometry(frame.target, stamp, target)

    def _make(self, type_: str, **fields: object) -> Message:
        return self._types[type_](**fields)

    def _time(self, stamp: _Stamp) -> Message:
        return self._make(
            "builtin_interfaces/msg/Time", sec=stamp.seconds, nanosec=stamp.nanoseconds
        )

    def _header(self, stamp: _Stamp, frame: str) -> Message:
        return self._make("std_msgs/msg/Header", stamp=self._time(stamp), frame_id=frame)

    def _vector(self, values: ArrayLike, type_: str = "Vector3") -> Message:
        x, y, z = np.asarray(values, np.float64).tolist()
        return self._make(f"geometry_msgs/msg/{type_}", x=x, y=y, z=z)

    def _quaternion(self, xyzw: tuple[float, ...]) -> Message:
        x, y, z, w = xyzw
        return self._make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def _pose(self, pose: Pose) -> Message:
        return self._make(
            "geometry_msgs/msg/Pose",
            position=self._vector(pose.position, "Point"),
            orientation=self._quaternion(pose.quaternion),
        )

    def _fixed(self) -> list[tuple[str, str, Pose]]:
        """Return what never moves: names of parent and child, and the child's pose."""
        fixed = [("map", "odom", STILL), ("camera_link", "camera_optical_frame", OPTICAL)]
        return [*fixed, ("base_link", "laser", self._laser)] if self._lidar.enabled else fixed

    def _transforms(self, stamp: _Stamp, told: list[tuple[str, str, Pose]]) -> Message:
        transforms = [
            self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(stamp, parent),
                child_frame_id=child,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._vector(pose.position),
                    rotation=self._quaternion(pose.quaternion),
                ),
            )
            for parent, child, pose in told
        ]
        return self._make("tf2_msgs/msg/TFMessage", transforms=transforms)

    def _own_odometry(self, frame: Frame, stamp: _Stamp, body: Pose) -> Message:
        tracker = frame.tracker
        moves = body.inside(tracker.velocity), tracker.angular_velocity
        return self._odometry(stamp, ("odom", "base_link"), body, moves)

    def _target_odometry(self, target: Subject, stamp: _Stamp, pose: Pose) -> Message:
        turning = pose.inside(np.array([0.0, 0.0, target.motion.yaw_rate]))
        moves = pose.inside(target.velocity), turning
        return self._odometry(stamp, ("map", "target"), pose, moves)

    def _odometry(
        self, stamp: _Stamp, frames: tuple[str, str], pose: Pose, moves: tuple[Floats, Floats]
    ) -> Message:
        twist = self._make(
            "geometry_msgs/msg/Twist", linear=self._vector(moves[0]), angular=self._vector(moves[1])
        )
        return self._make(
            "nav_msgs/msg/Odometry",
            header=self._header(stamp, frames[0]),
            child_frame_id=frames[1],
            pose=self._make(
                "geometry_msgs/msg/PoseWithCovariance", pose=self._pose(pose), covariance=_EXACTLY
            ),
            twist=self._make(
                "geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=_EXACTLY
            ),
        )

    def _measured(self, frame: Frame, stamp: _Stamp) -> Iterator[tuple[str, Message]]:
        """Yield what IMU and GPS tell."""
        told = frame.sensors
        if told is None:
            return
        w, x, y, z = told[_ATTITUDE].tolist()
        yield (
            "/imu/data",
            self._make(
                "sensor_msgs/msg/Imu",
                header=self._header(stamp, "base_link"),
                orientation=self._quaternion((x, y, z, w)),
                orientation_covariance=self._turned,
                angular_velocity=self._vector(told[_TURNING]),
                angular_velocity_covariance=self._turning,
                linear_acceleration=self._vector(told[_FELT]),
                linear_acceleration_covariance=self._felt,
            ),
        )
        east, north, up = told[_POSITION].tolist()
        longitude, latitude = self._projection.degrees([[east, north]])[0].tolist()
        yield (
            "/gps/fix",
            self._make(
                "sensor_msgs/msg/NavSatFix",
                header=self._header(stamp, "base_link"),
                status=self._make("sensor_msgs/msg/NavSatStatus", status=0, service=_GPS),
                latitude=latitude,
                longitude=longitude,
                altitude=up,
                position_covariance=self._placed,
                position_covariance_type=_DIAGONAL_KNOWN if self._placed.any() else _UNKNOWN,
            ),
        )

    def _reading(
        self, quantity: _Quantity, stamp: _Stamp, value: Floats, covariance: Floats
    ) -> Message:
        """Return what a further sensor tells."""
        header, field = self._header(stamp, "base_link"), quantity.field
        if quantity.width == 3:
            told = {field: self._vector(value), f"{field}_covariance": covariance}
        else:
            told = {field: float(value[0]), "variance": float(covariance[0])}
        return self._make(quantity.type, header=header, **told)

    def _pictured(self, frame: Frame, stamp: _Stamp) -> Iterator[tuple[str, Message]]:
        assert frame.rgb is not None
        header, camera = self._header(stamp, "camera_optical_frame"), frame.camera
        yield (
            "/camera/image_raw/compressed",
            self._make(
                "sensor_msgs/msg/CompressedImage",
                header=header,
                format="jpeg",
                data=np.frombuffer(jpeg_bytes(frame.rgb, self._quality), np.uint8),
            ),
        )
        matrix = optical_matrix(camera)
        region = self._make(
            "sensor_msgs/msg/RegionOfInterest",
            **{"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False},
        )
        yield (
            "/camera/camera_info",
            self._make(
                "sensor_msgs/msg/CameraInfo",
                header=header,
                height=camera.height,
                width=camera.width,
                distortion_model="equidistant"
                if camera.distortion_model == "fisheye"
                else "plumb_bob",
                d=np.array(camera.distortion, np.float64),
                k=matrix.ravel(),
                r=_NOT_RECTIFIED,
                p=np.column_stack([matrix, np.zeros(3)]).ravel(),
                binning_x=0,
                binning_y=0,
                roi=region,
            ),
        )

    def _scan(self, ranges: Floats, stamp: _Stamp) -> Message:
        """Return a turn of the lidar, from right behind counter-clockwise; ours is clockwise."""
        step = 2.0 * math.pi / len(ranges)
        return self._make(
            "sensor_msgs/msg/LaserScan",
            header=self._header(stamp, "laser"),
            angle_min=step - math.pi,
            angle_max=math.pi,
            angle_increment=step,
            time_increment=0.0,
            scan_time=1.0 / self._lidar.frequency,
            range_min=self._lidar.min_range,
            range_max=self._lidar.max_range,
            ranges=ranges[::-1].astype(np.float32),
            intensities=np.zeros(0, np.float32),
        )

    def _command(self, command: Floats, stamp: _Stamp) -> Message:
        forward, left, up, turning = command.tolist()
        return self._make(
            "geometry_msgs/msg/TwistStamped",
            header=self._header(stamp, "base_link"),
            twist=self._make(
                "geometry_msgs/msg/Twist",
                linear=self._vector([forward, left, up * _PER_SECOND]),
                angular=self._vector([0.0, 0.0, turning]),
            ),
        )

    def _detected(self, frame: Frame, stamp: _Stamp) -> Iterator[tuple[str, Message]]:
        """Yield the boxes of all moving objects of which a pixel is visible, in order of ids."""
        seen = [each for each in (frame.target, *frame.others) if each.seen_pixels > 0]
        seen.sort(key=lambda each: each.object_id)
        picture = self._header(stamp, "camera_optical_frame")
        flat = {each.object_id: self._flat(each, picture) for each in seen}
        yield "/detections_2d", self._detections("2D", picture, list(flat.values()))
        world = self._header(stamp, "map")
        solid = [self._solid(each, world) for each in seen]
        yield "/detections_3d", self._detections("3D", world, solid)
        target = [flat[frame.target.object_id]] if frame.target.object_id in flat else []
        yield "/target/detections_2d", self._detections("2D", picture, target)

    def _detections(self, sort: str, header: Message, detections: list[Message]) -> Message:
        type_ = f"vision_msgs/msg/Detection{sort}Array"
        return self._make(type_, header=header, detections=detections)

    def _flat(self, subject: Subject, header: Message) -> Message:
        x, y, width, height = picture_box(subject.visible_box)
        position = self._make("vision_msgs/msg/Point2D", x=x, y=y)
        return self._make(
            "vision_msgs/msg/Detection2D",
            header=header,
            results=[self._hypothesis(subject, STILL)],
            bbox=self._make(
                "vision_msgs/msg/BoundingBox2D",
                center=self._make("vision_msgs/msg/Pose2D", position=position, theta=0.0),
                size_x=width,
                size_y=height,
            ),
            id=str(subject.object_id),
        )

    def _solid(self, subject: Subject, header: Message) -> Message:
        pose, size = pose_of_subject(subject)
        return self._make(
            "vision_msgs/msg/Detection3D",
            header=header,
            results=[self._hypothesis(subject, pose)],
            bbox=self._make(
                "vision_msgs/msg/BoundingBox3D", center=self._pose(pose), size=self._vector(size)
            ),
            id=str(subject.object_id),
        )

    def _hypothesis(self, subject: Subject, pose: Pose) -> Message:
        name = subject.object_class.name.lower()
        return self._make(
            "vision_msgs/msg/ObjectHypothesisWithPose",
            hypothesis=self._make("vision_msgs/msg/ObjectHypothesis", class_id=name, score=1.0),
            pose=self._make(
                "geometry_msgs/msg/PoseWithCovariance", pose=self._pose(pose), covariance=_EXACTLY
            ),
        )


def _covariance(errors: ReadingConfig) -> Floats:
    """Return the covariance of a sensor with these errors, row by row, shape (9,); all 0, that is
    unknown, if it has none.
    """
    square = errors.noise * errors.noise + errors.bias * errors.bias
    return (square * np.eye(3)).ravel()
