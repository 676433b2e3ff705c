import dataclasses
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

from eyas.engine.camera.config import MountConfig
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.optics.lens import BROWN, FISHEYE, lens_of
from eyas.engine.exports.frame import CameraPose, RecordedAction, RecordedBody
from eyas.engine.exports.label import label_of
from eyas.engine.exports.writer import Summary
from eyas.engine.sensors.config import LidarConfig, ReadingConfig, SensorsConfig
from eyas.engine.sim.config import SimConfig

rosbags = pytest.importorskip("rosbags")

from rosbags.highlevel import AnyReader

from eyas.robotics.ros import types
from eyas.robotics.ros.bag import RosbagMcapWriter, RosbagWriter
from eyas.robotics.ros.geometry import rotation_of
from eyas.robotics.ros.messages import TOPICS
from eyas.robotics.ros.types import message_types

SIDEWAYS = np.array([math.cos(0.3), math.sin(0.3) * 0.6, 0.0, math.sin(0.3) * 0.8])
WRITERS = [RosbagWriter, RosbagMcapWriter]


def turned(yaw, down):
    """Forward, left and up of a camera that looks somewhere, in the world."""
    c, s, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(down), math.sin(down)
    return np.array([[c * cp, -s, c * sp], [s * cp, c, s * sp], [-sp, 0.0, cp]])


@pytest.fixture
def flown(frame):
    """Makes a frame of a drone that is tilted and looks down at its target."""

    def one(number, **changes):
        body = RecordedBody(
            position=np.array([1.0, 2.0, 22.0 + number]),
            velocity=np.array([3.0, 4.0, 0.5]),
            acceleration=np.zeros(3),
            orientation=SIDEWAYS,
            angular_velocity=np.array([0.1, 0.2, 0.3]),
            gimbal=np.zeros(3),
        )
        lens = changes.pop("lens", lens_of(BROWN))
        pose = CameraPose(np.array([1.1, 2.2, 21.9]), turned(0.2, 0.9), 0.8, 64, 48, lens)
        return frame(number, tracker=body, camera=pose, **changes)

    return one


def written(writer, run, episode, frames):
    part = writer(run).begin(episode)
    for each in frames:
        part.add(each)
    part.finish()
    return episode.folder / writer.name


def read(bag):
    """All messages of a bag by topics, each with its time."""
    types = message_types("this test")
    found = {name: [] for name in TOPICS}
    with AnyReader([bag], default_typestore=types) as reader:
        last = 0
        for connection, time, raw in reader.messages():
            assert time >= last
            last = time
            message = reader.deserialize(raw, connection.msgtype)
            found[connection.topic].append((time, message))
    return found


def vector(message):
    return np.array([message.x, message.y, message.z])


def matrix(pose):
    """The transformation from a child's frame to its parent's, shape (4, 4), by the textbook."""
    q = pose.rotation
    x, y, z, w = q.x, q.y, q.z, q.w
    whole = np.eye(4)
    whole[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    whole[:3, 3] = vector(pose.translation)
    return whole


def to_map(found, frame):
    """The transformation from a frame to the map at the first instant, along the tree."""
    links = {
        each.child_frame_id: (each.header.frame_id, matrix(each.transform))
        for topic in ("/tf_static", "/tf")
        for each in found[topic][0][1].transforms
    }
    whole = np.eye(4)
    while frame != "map":
        frame, link = links[frame]
        whole = link @ whole
    return whole


@pytest.mark.parametrize("writer", WRITERS)
def test_both_kinds_of_bags_are_read_by_rosbags(run, episode, flown, writer):
    command = RecordedAction(1, np.array([1.0, 2.0, 0.004, -0.5]))
    frames = [flown(number, action=command) for number in range(3)]
    bag = written(writer, run, episode, frames)
    found = read(bag)
    counts = {name: 1 if name == "/tf_static" else 3 for name in TOPICS}
    assert {name: len(messages) for name, messages in found.items()} == counts
    assert [time for time, _ in found["/clock"]] == [1_000_000_000, 1_040_000_000, 1_080_000_000]
    for time, message in found["/odom"]:
        assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time
    twist = found["/cmd_vel"][0][1].twist
    assert vector(twist.linear).tolist() == [1.0, 2.0, 2.0]
    assert twist.angular.z == -0.5
    assert writer(run).read(episode.folder) == Summary(3)


def test_mcaps_own_reader_finds_every_checksum_right(run, episode, flown):
    reader = pytest.importorskip("mcap.reader")
    bag = written(RosbagMcapWriter, run, episode, [flown(number) for number in range(3)])
    types = message_types("this test")
    with (bag / "rosbag-mcap_0.mcap").open("rb") as file:
        opened = reader.make_reader(file, validate_crcs=True)
        assert opened.get_header().profile == "ros2"
        seen = [
            (channel.topic, types.deserialize_cdr(message.data, schema.name))
            for schema, channel, message in opened.iter_messages()
        ]
        static = next(
            channel
            for channel in opened.get_summary().channels.values()
            if channel.topic == "/tf_static"
        )
    assert "durability: 1" in static.metadata["offered_qos_profiles"]
    assert {topic for topic, _ in seen} == set(TOPICS) - {"/cmd_vel"}


def test_boxes_are_those_of_the_labels(run, episode, flown, frame):
    other = dataclasses.replace(
        frame(0).target, object_id=65536 + 1, visible_box=np.array([0, 3, 9, 8], np.int32)
    )
    shown = flown(0, others=(other,))
    found = read(written(RosbagWriter, run, episode, [shown]))
    label = label_of(shown, episode)
    boxes = {str(label["target_id"]): label["target_visible_box"]}
    boxes |= {str(each["id"]): each["visible_box"] for each in label["others"]}
    flat = found["/detections_2d"][0][1]
    assert flat.header.frame_id == "camera_optical_frame"
    assert [each.id for each in flat.detections] == sorted(boxes, key=int)
    for each in flat.detections:
        x, y = each.bbox.center.position.x + 0.5, each.bbox.center.position.y + 0.5
        half = 0.5 * each.bbox.size_x, 0.5 * each.bbox.size_y
        assert boxes[each.id] == [x - half[0], y - half[1], x + half[0], y + half[1]]
    solid = {each.id: each.bbox for each in found["/detections_3d"][0][1].detections}
    target = solid[str(label["target_id"])]
    assert vector(target.center.position) == pytest.approx(np.mean(label["target_corners"], axis=0))
    assert vector(target.size) == pytest.approx(label["target_size"])
    assert [each.id for each in found["/target/detections_2d"][0][1].detections] == [
        str(label["target_id"])
    ]


def test_a_target_out_of_sight_is_not_detected(run, episode, flown, frame):
    hidden = dataclasses.replace(frame(0).target, seen_pixels=0)
    found = read(written(RosbagWriter, run, episode, [flown(0, target=hidden)]))
    assert found["/detections_2d"][0][1].detections == []
    assert found["/target/detections_2d"][0][1].detections == []
    assert found["/target/odom"][0][1].child_frame_id == "target"


def test_the_tree_of_frames_leads_to_the_pixel_that_shows_a_point(run, episode, flown):
    shown = flown(0)
    found = read(written(RosbagWriter, run, episode, [shown]))
    camera = shown.camera
    point = camera.position + camera.rotation @ [20.0, 1.5, -2.5]  # ahead, left, below
    seen = np.linalg.inv(to_map(found, "camera_optical_frame")) @ [*point, 1.0]
    assert seen[:3] == pytest.approx([-1.5, 2.5, 20.0])  # right, down, ahead
    info = found["/camera/camera_info"][0][1]
    x, y, z = info.k.reshape(3, 3) @ seen[:3]
    ours = camera.intrinsics @ seen[:3]
    assert [x / z, y / z] == pytest.approx(ours[:2] / ours[2] - 0.5)
    assert np.array_equal(info.p.reshape(3, 4)[:, :3], info.k.reshape(3, 3))


def test_odometry_is_the_true_motion_in_the_bodys_frame(run, episode, flown):
    shown = flown(0)
    found = read(written(RosbagWriter, run, episode, [shown]))
    odometry = found["/odom"][0][1]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("odom", "base_link")
    body = to_map(found, "base_link")
    assert body[:3, 3].tolist() == shown.tracker.position.tolist()
    moved = body[:3, :3] @ vector(odometry.twist.twist.linear)
    assert moved == pytest.approx(shown.tracker.velocity)
    assert vector(odometry.twist.twist.angular).tolist() == [0.1, 0.2, 0.3]
    target = found["/target/odom"][0][1].twist.twist
    assert vector(target.linear) == pytest.approx([13.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("lens", "model", "numbers"),
    [
        (lens_of(BROWN), "plumb_bob", [0, 0, 0, 0, 0]),
        (
            lens_of(BROWN, (-0.2, 0.05, 0.01, 0), (0.001, 0.002)),
            "plumb_bob",
            [-0.2, 0.05, 0.001, 0.002, 0.01],
        ),
        (lens_of(FISHEYE, (0.1, 0.02, 0.003, 0.0004)), "equidistant", [0.1, 0.02, 0.003, 0.0004]),
    ],
)
def test_camera_info_names_the_lens(run, episode, flown, lens, model, numbers):
    found = read(written(RosbagWriter, run, episode, [flown(0, lens=lens)]))
    info = found["/camera/camera_info"][0][1]
    assert (info.distortion_model, info.width, info.height) == (model, 64, 48)
    assert info.d.tolist() == numbers


def test_scans_turn_counter_clockwise_from_behind(run, episode, flown):
    ranges = np.full(400, np.inf)
    ranges[[0, 100, 200, 300]] = [1.0, 2.0, 3.0, 4.0]  # behind, left, ahead, right
    mount = MountConfig(x=0.1, z=0.2, pitch=0.5)
    run = dataclasses.replace(run, config=SimConfig(lidar=LidarConfig(enabled=True, mount=mount)))
    found = read(written(RosbagWriter, run, episode, [flown(0, lidar=ranges)]))
    scan = found["/scan"][0][1]
    angle = scan.angle_min + scan.angle_increment * np.arange(400)
    seen = np.flatnonzero(np.isfinite(scan.ranges))
    assert scan.ranges[seen].tolist() == [4.0, 3.0, 2.0, 1.0]
    quarter = math.pi / 2
    assert angle[seen] == pytest.approx([-quarter, 0.0, quarter, 2 * quarter], abs=1e-4)
    laser = np.linalg.inv(to_map(found, "base_link")) @ to_map(found, "laser")
    assert laser[:3, 3] == pytest.approx([0.1, 0.0, 0.2])
    assert laser[:3, 0] == pytest.approx([math.cos(0.5), 0.0, -math.sin(0.5)])  # ahead is lower


def test_gps_and_imu_tell_what_the_sensors_tell(run, episode, flown):
    told = np.zeros(19)
    told[0:3], told[6:9], told[9:12] = [0.0, 1000.0, 30.0], [0.0, 0.0, 9.81], [0.1, 0.2, 0.3]
    told[12:16] = [0.5, 0.5, -0.5, 0.5]
    errors = SensorsConfig(gps_position=ReadingConfig(noise=0.3, bias=0.4))
    run = dataclasses.replace(run, config=SimConfig(sensors=errors))
    found = read(written(RosbagWriter, run, episode, [flown(0, sensors=told)]))
    fix = found["/gps/fix"][0][1]
    assert fix.latitude - 47.397742 == pytest.approx(1000 / 111_177, rel=1e-3)
    assert (fix.longitude, fix.altitude) == (8.545594, 30.0)
    assert fix.position_covariance[[0, 4, 8]] == pytest.approx([0.25] * 3)
    assert fix.position_covariance_type == 2
    imu = found["/imu/data"][0][1]
    assert vector(imu.linear_acceleration).tolist() == [0.0, 0.0, 9.81]
    turn = imu.orientation
    assert [turn.x, turn.y, turn.z, turn.w] == [0.5, -0.5, 0.5, 0.5]


@pytest.mark.parametrize("writer", WRITERS)
def test_the_same_frames_give_the_same_bytes(run, episode, flown, tmp_path, writer):
    bags = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        own = dataclasses.replace(episode, folder=tmp_path / name)
        bags.append(written(writer, run, own, [flown(number) for number in range(2)]))
    files = [sorted(path.relative_to(bag) for path in bag.iterdir()) for bag in bags]
    assert files[0] == files[1] == sorted(Path(name).relative_to(writer.name)
                                          for name in writer.files.episode)  # fmt: skip
    for name in files[0]:
        assert (bags[0] / name).read_bytes() == (bags[1] / name).read_bytes()


@pytest.mark.parametrize("writer", WRITERS)
def test_an_unfinished_bag_is_none(run, episode, flown, writer):
    part = writer(run).begin(episode)
    part.add(flown(0))
    inside = [path.name for path in (episode.folder / writer.name).iterdir()]
    assert len(inside) == 1
    assert inside[0].endswith(".part")  # also if the process is killed now
    assert writer(run).read(episode.folder) is None
    again = writer(run).begin(episode)  # over what a killed process has left
    again.add(flown(0))
    again.finish()
    assert writer(run).read(episode.folder) == Summary(1)
    part.abandon()


@pytest.mark.parametrize("writer", WRITERS)
def test_an_abandoned_bag_leaves_nothing(run, episode, flown, writer):
    part = writer(run).begin(episode)
    part.add(flown(0))
    part.abandon()
    assert list((episode.folder / writer.name).iterdir()) == []


def test_the_description_is_what_ros_reads(run, episode, flown):
    yaml = pytest.importorskip("yaml")
    bag = written(RosbagWriter, run, episode, [flown(number) for number in range(2)])
    text = (bag / "metadata.yaml").read_text()
    told = yaml.safe_load(text)["rosbag2_bagfile_information"]
    assert told == json.loads(text)["rosbag2_bagfile_information"]
    assert told["relative_file_paths"] == ["rosbag_0.db3"]
    assert told["duration"] == {"nanoseconds": 40_000_000}
    latched = next(
        each["topic_metadata"]
        for each in told["topics_with_message_count"]
        if each["topic_metadata"]["name"] == "/tf_static"
    )
    assert yaml.safe_load(latched["offered_qos_profiles"])[0]["durability"] == 1


def test_a_missing_extra_is_told_in_one_line(run, monkeypatch):
    types._registered.cache_clear()
    monkeypatch.setitem(sys.modules, "rosbags.typesys", None)
    with pytest.raises(MissingExtraError, match=r"^video\.writers: 'rosbag' needs the extra 'ros'"):
        RosbagWriter(run)


def test_the_matrix_of_a_quaternion_is_a_rotation_about_its_axis():
    axis, angle = np.array([2.0, -1.0, 2.0]) / 3.0, 0.7
    turned = rotation_of(np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)]))
    assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    assert turned @ axis == pytest.approx(axis)
    quarter = rotation_of(np.array([math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]))
    assert quarter @ np.array([1.0, 0.0, 0.0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
