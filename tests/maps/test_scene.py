import dataclasses
import json
import math
import struct

import numpy as np
import pytest

from eyas.engine.exports.boxes import box_of
from eyas.engine.exports.capture import frame_of, moment_of
from eyas.engine.exports.frame import CameraPose, RecordedAction
from eyas.engine.exports.writer import Summary
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.motion import ActorState
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs
from eyas.maps.formats.gltf import flight
from eyas.maps.formats.gltf.flight import SceneWriter, box_mesh, mover_mesh, pose_of


@pytest.fixture
def film(run, episode, frame, monkeypatch):
    """The scene of four frames in an empty world, in which the camera turns by more than half a
    turn, and another car is seen in the second and third frame only."""
    monkeypatch.setattr(flight, "load_scene", lambda *_: Scene.empty())
    other = dataclasses.replace(
        frame(0).target, object_id=65536 + 9, type="Bus", object_class=ObjectClass.BUS
    )

    def write():
        part = SceneWriter(run).begin(episode)
        for number in range(4):
            yaw = 1.2 * number
            c, s = math.cos(yaw), math.sin(yaw)
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            pose = CameraPose(np.array([number, 2.0, 20.0]), turn, 0.8, 64, 48)
            part.add(frame(number, camera=pose, others=(other,) if number in (1, 2) else ()))
        part.finish()
        return episode.folder / "scene.glb"

    return write


def opened(path):
    """What a file tells, and a reader of its accessors."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    told, body = json.loads(data[20 : 20 + length]), data[28 + length :]

    def values(index):
        accessor = told["accessors"][index]
        view = told["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        count = accessor["count"] * width
        return np.frombuffer(body, np.float32, count, view["byteOffset"]).reshape(-1, width)

    return told, values


def track(told, values, name, path):
    """Times and values of a property of a node."""
    (animation,) = told["animations"]
    names = {index: node["name"] for index, node in enumerate(told["nodes"])}
    for channel in animation["channels"]:
        if (names[channel["target"]["node"]], channel["target"]["path"]) == (name, path):
            sampler = animation["samplers"][channel["sampler"]]
            return values(sampler["input"])[:, 0], values(sampler["output"])
    raise KeyError((name, path))


def axes(quaternion):
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_the_camera_moves_and_looks_as_in_the_frames(film):
    told, values = opened(film())
    times, places = track(told, values, "camera", "translation")
    assert times == pytest.approx(0.002 * (31 + 20 * np.arange(4)))
    assert places.tolist() == [[number, 2.0, 20.0] for number in range(4)]
    _, turns = track(told, values, "camera", "rotation")
    for number, turn in enumerate(turns):
        yaw = 1.2 * number
        ahead = axes(turn) @ [0, 0, -1]  # where cameras of glTF look
        assert ahead == pytest.approx([math.cos(yaw), math.sin(yaw), 0.0], abs=1e-6)
        assert axes(turn) @ [0, 1, 0] == pytest.approx([0, 0, 1], abs=1e-6)
    assert ((turns[1:] * turns[:-1]).sum(axis=1) > 0).all()  # never the long way round
    lens = told["cameras"][0]["perspective"]
    assert lens["aspectRatio"] == pytest.approx(64 / 48)
    assert math.tan(0.5 * lens["yfov"]) == pytest.approx(0.75 * math.tan(0.4))


def test_movers_are_there_while_they_are_seen(film):
    told, values = opened(film())
    _, scale = track(told, values, "bus-65545", "scale")
    assert scale[:, 0].tolist() == [0.0, 1.0, 1.0, 0.0]
    _, places = track(told, values, "target-65539", "translation")
    assert places[0] == pytest.approx([14.0, 2.0, 0.0])  # on the road
    with pytest.raises(KeyError):
        track(told, values, "target-65539", "scale")


def test_movers_have_the_shapes_of_their_models_or_boxes_where_their_boxes_are(film, frame):
    told, _ = opened(film())

    def extent(name):
        (node,) = (node for node in told["nodes"] if node["name"] == name)
        primitives = told["meshes"][node["mesh"]]["primitives"]
        ends = [told["accessors"][one["attributes"]["POSITION"]] for one in primitives]
        looks = [told["materials"][one["material"]] for one in primitives]
        colours = [look["pbrMetallicRoughness"]["baseColorFactor"][:3] for look in looks]
        low = np.min([end["min"] for end in ends], axis=0) + node["translation"]
        return low, np.max([end["max"] for end in ends], axis=0) + node["translation"], colours

    low, high, colours = extent("target-65539")
    assert np.abs(high - low - (4.85, 1.9, 1.8)).max() < 0.05
    assert low[2] == pytest.approx(0.0, abs=0.01)
    assert abs(0.5 * (low + high)[0] - 13.0) < 0.01
    red, green, blue = (1.1028 * part for part in (0.75, 0.5, 0.25))  # paint of its texture
    assert any(np.allclose(each, np.power([red, green, blue], 2.2), atol=1e-4) for each in colours)
    low, high, _ = extent("bus-65545")  # "Bus" is no model
    corners = frame(0).target.corners
    assert low == pytest.approx(corners.min(axis=0), abs=1e-5)
    assert high == pytest.approx(corners.max(axis=0), abs=1e-5)


def test_the_shape_of_a_model_fills_its_box():
    """In a true simulation."""
    sim = build_simulation(SimConfig(world={"map": "simpleway-grass"}), together(1))
    sim.reset()
    picture = Picture.create(1, 48, 64, subject=True)
    moment = moment_of(sim, 0, picture, 0, {"traffic"})
    subject = frame_of(moment, 0, picture, 0, 0, RecordedAction(-1, None)).target
    place, axes = pose_of(subject)
    points = mover_mesh(subject, (1.0, 1.0, 1.0)).positions.astype(float) @ axes.T + place
    box = box_of(subject.corners)
    inside = (points - box.centre) @ box.rotation
    assert np.abs(inside).max(axis=0) == pytest.approx(0.5 * box.size, abs=0.1)


def test_movers_tilt_as_the_renderer_draws_them(frame):
    subject = frame(0).target
    motion = dataclasses.replace(subject.motion, slope=0.3)
    subject = dataclasses.replace(subject, yaw=0.8, motion=motion)
    rigs, actors = Rigs(np.zeros(1, np.int32)), ActorState.create(1, 1)
    actors.position[0, 0] = subject.position - [0.0, 0.0, motion.rise]
    actors.yaw[:], actors.slope[:], actors.present[:] = 0.8, 0.3, True
    drawn = rigs.draw_list(1)
    looks = Looks(np.zeros((1, 1), np.int32), np.ones((1, 1, 3), np.float32))
    rigs.pose(actors, looks, drawn)
    place, axes = pose_of(subject)
    body = place - axes[:, 0]  # its middle is 1 m behind the reference point
    np.testing.assert_allclose(drawn.pose[0, 0], np.column_stack([axes, body]), atol=1e-5)


def test_a_scene_tells_how_many_frames_it_has(film, run, episode):
    assert SceneWriter(run).read(episode.folder) is None
    path = film()
    assert SceneWriter(run).read(episode.folder) == Summary(4)
    whole = path.read_bytes()
    film()
    assert path.read_bytes() == whole
    path.write_bytes(whole[:-1])
    assert SceneWriter(run).read(episode.folder) is None


def test_boxes_face_outwards_and_have_their_size():
    box = box_mesh((4.0, 2.0, 1.5), ObjectClass.CAR)
    assert np.ptp(box.positions, axis=0).tolist() == [4.0, 2.0, 1.5]
    corners = box.positions[box.triangles].astype(float)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((across * box.normals[box.triangles[:, 0]]).sum(axis=1) > 0).all()
    assert np.einsum("ij,ij->", corners[:, 0], across) / 6 == pytest.approx(4.0 * 2.0 * 1.5)
