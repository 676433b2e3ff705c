"""Pictures without loss, as other libraries read them."""

from dataclasses import replace

import cv2
import numpy as np

from eyas.engine.exports.registry import WRITERS
from eyas.engine.exports.writer import Summary
from eyas.engine.sensors.config import SensorsConfig
from eyas.engine.state.scene import ACTOR_OBJECT, SKY_OBJECT, ObjectClass


def read(episode, name):
    return cv2.imread(str(episode.folder / name), cv2.IMREAD_UNCHANGED)


def written(name, run, episode, *frames):
    writer = WRITERS.get(name)(run)
    part = writer.begin(episode)
    for each in frames:
        part.add(each)
    part.finish()
    assert writer.read(episode.folder) == Summary(len(frames))


def test_colours_are_those_of_the_picture(run, episode, frame):
    rgb = np.random.default_rng(0).integers(0, 255, (48, 64, 3), np.uint8, endpoint=True)
    written("png", run, episode, frame(0, rgb=rgb))
    np.testing.assert_array_equal(read(episode, "000000.png")[..., ::-1], rgb)


def test_masks_number_parked_objects_from_the_top(run, episode, frame):
    shown, classes = np.full((48, 64), 12, np.int32), np.full((48, 64), ObjectClass.CAR, np.uint8)
    shown[0], classes[1], shown[2] = SKY_OBJECT, ObjectClass.BUILDING, 1
    written("masks", run, episode, frame(0, object_id=shown, class_id=classes))
    masks = read(episode, "masks/000000.png")
    assert [set(row.tolist()) for row in masks[:4]] == [{0}, {0}, {65534}, {65523}]


def test_masks_number_moving_objects_from_1(run, episode, frame):
    shown = np.full((48, 64), 12, np.int32)
    shown[0], shown[1], shown[2] = SKY_OBJECT, ACTOR_OBJECT, ACTOR_OBJECT + 300
    written("masks", run, episode, frame(0, object_id=shown))
    masks = read(episode, "masks/000000.png")
    assert masks.dtype == np.uint16
    assert [set(row.tolist()) for row in masks[:4]] == [{0}, {1}, {301}, {0}]


def test_classes_are_as_drawn(run, episode, frame):
    classes = np.arange(48 * 64).reshape(48, 64).astype(np.uint8)
    written("classes", run, episode, frame(0, class_id=classes))
    np.testing.assert_array_equal(read(episode, "classes/000000.png"), classes)


def test_depth_is_in_units_and_0_where_it_does_not_fit(run, episode, frame):
    depth = np.full((48, 64), 0.001, np.float32)
    depth[0], depth[1], depth[2], depth[3] = np.inf, 655.35, 655.36, 12.344
    written("depth", run, episode, frame(0, depth=depth))
    units = read(episode, "depth/000000.png")
    assert units.dtype == np.uint16
    assert units[:5, 0].tolist() == [0, 65535, 0, 1234, 1]


def test_arrays_are_those_of_the_renderer(run, episode, frame):
    rng = np.random.default_rng(0)
    arrays = {
        "depth": rng.random((48, 64), np.float32),
        "object_id": rng.integers(-1, 70_000, (48, 64), np.int32),
        "class_id": rng.integers(0, 20, (48, 64), np.uint8),
    }
    written("arrays", run, episode, frame(0, **arrays))
    with np.load(episode.folder / "arrays/000000.npz") as file:
        assert sorted(file.files) == sorted(arrays)
        for name, array in arrays.items():
            assert file[name].dtype == array.dtype
            np.testing.assert_array_equal(file[name], array)
    before = (episode.folder / "arrays/000000.npz").read_bytes()
    written("arrays", run, episode, frame(0, **arrays))
    assert (episode.folder / "arrays/000000.npz").read_bytes() == before


def test_a_missing_file_is_noticed(run, episode, frame):
    written("masks", run, episode, frame(0), frame(1), frame(2))
    (episode.folder / "masks/000001.png").unlink()
    assert WRITERS.get("masks")(run).read(episode.folder) is None


def test_readings_have_the_names_of_packets(run, episode, frame):
    written("sensors", run, episode, frame(0, sensors=np.arange(19.0)), frame(1))
    header, first, _ = (episode.folder / "sensors.csv").read_text().splitlines()
    row = dict(zip(header.split(","), first.split(","), strict=True))
    assert (row["frame"], row["step"], row["position_x"]) == ("0", "31", "0")
    assert (row["orientation_w"], row["yaw"]) == ("12", "18")
    told = [frame(0, sensors=np.arange(19.0), rotors=np.arange(4.0) + 500.0)]
    written("sensors", run, episode, *told)
    header, first = (episode.folder / "sensors.csv").read_text().splitlines()
    row = dict(zip(header.split(","), first.split(","), strict=True))
    assert (row["yaw"], row["rotor_1"], row["rotor_4"]) == ("18", "500", "503")
    further = run.config.model_copy(update={"sensors": SensorsConfig(further=["barometer"])})
    run = replace(run, config=further)
    written("sensors", run, episode, replace(told[0], signals={"pressure": np.array([957.0])}))
    header, first = (episode.folder / "sensors.csv").read_text().splitlines()
    row = dict(zip(header.split(","), first.split(","), strict=True))
    assert (row["yaw"], row["pressure"], row["rotor_1"]) == ("18", "957", "500")
