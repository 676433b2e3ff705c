"""What a node of ROS 2 is on the wire: Cyclone DDS with ROS' names of topics and types.

python ros_node.py DOMAIN

Its types are written by hand from the definitions in common_interfaces. It flies the drone, and
prints what it hears as JSON.
"""

import json
import math
import sys
import time
from dataclasses import dataclass, field

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs::msg::dds_::Clock_"):
    clock: Time


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class CompressedImage(IdlStruct, typename="sensor_msgs::msg::dds_::CompressedImage_"):
    header: Header
    format: str
    data: sequence[uint8]


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Point(IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Point
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    twist: Twist
    covariance: array[float64, 36]


@dataclass
class Odometry(IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
LATCHED = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(1),
)
SENSOR = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))


class Node:
    def __init__(self, domain):
        self.participant = DomainParticipant(domain)
        self.heard = {}
        self.readers = {
            name: DataReader(self.participant, Topic(self.participant, f"rt/{name}", kind), qos=how)
            for name, kind, how in (
                ("clock", Clock, SENSOR),
                ("odom", Odometry, RELIABLE),
                ("camera/image_raw/compressed", CompressedImage, SENSOR),
                ("tf", TFMessage, RELIABLE),
                ("tf_static", TFMessage, LATCHED),
            )
        }
        self.writers = {
            name: DataWriter(self.participant, Topic(self.participant, f"rt/{name}", Twist),
                             qos=RELIABLE)
            for name in ("cmd_vel", "camera/cmd_vel")
        }  # fmt: skip

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for name, reader in self.readers.items():
                for sample in reader.take(10):
                    self.heard.setdefault(name, []).append(sample)
            time.sleep(0.01)

    def looks(self):
        """Return the pitch of the camera on the body, positive down [rad]."""
        last = self.heard["tf"][-1].transforms
        q = next(each for each in last if each.child_frame_id == "camera_link").transform.rotation
        return math.asin(max(-1.0, min(1.0, 2.0 * (q.w * q.y - q.z * q.x))))

    def place(self):
        at = self.heard["odom"][-1].pose.pose.position
        return [at.x, at.y, at.z]


def main():
    node = Node(int(sys.argv[1]))
    end = time.monotonic() + 100.0
    while len(node.heard) < 5 and time.monotonic() < end:
        node.spin(0.1)
    node.spin(0.5)
    looked = node.looks()
    begun = node.place(), node.heard["clock"][-1].clock
    for _ in range(30):
        node.writers["cmd_vel"].write(Twist(Vector3(2.0, 0.0, 1.0)))
        node.writers["camera/cmd_vel"].write(Twist(Vector3(), Vector3(0.0, -0.2, 0.4)))
        node.spin(0.1)
    ended = node.place(), node.heard["clock"][-1].clock
    picture = node.heard["camera/image_raw/compressed"][-1]
    seconds = [at.sec + at.nanosec * 1e-9 for at in (begun[1], ended[1])]
    print(json.dumps({
        "places": [begun[0], ended[0]], "seconds": seconds, "format": picture.format,
        "jpeg": [bytes(picture.data)[:3].hex(), len(picture.data)],
        "frames": [node.heard["odom"][-1].header.frame_id, picture.header.frame_id],
        "static": [each.child_frame_id for each in node.heard["tf_static"][-1].transforms],
        "looks": [looked, node.looks()],
        "speeds": [round(one.twist.twist.linear.x, 2) for one in node.heard["odom"]],
    }))  # fmt: skip


if __name__ == "__main__":
    main()
