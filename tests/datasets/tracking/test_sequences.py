"""Sequences of others: found in folders as their benchmarks lay them out, and read as written."""

import shutil

import numpy as np
import pytest
from PIL import Image

from eyas.datasets.tracking.run import Scoring, parsed_box, run
from eyas.datasets.tracking.sequences import read_truth, sequences_in
from eyas.engine.camera.config import CameraConfig
from eyas.engine.core.errors import EyasError
from eyas.engine.recordings.export import ExportOptions, export
from eyas.engine.recordings.format import left_top_width_height, objects_of
from eyas.engine.recordings.recording import load
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.video import VideoConfig
from eyas.engine.video import run as video


@pytest.fixture(scope="module")
def flights(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sequences") / "flights"
    config = EyasConfig(
        seed=5,
        camera=CameraConfig(width=96, height=72),
        video=VideoConfig(channels=2, fps=10.0, total_time=3.0, flight="follow",
                          writers=("png", "labels")),
    )  # fmt: skip
    video.run(config, folder, quiet=True)
    return folder


SINGLE = ("got10k", "otb", "lasot", "uav123", "vot", "visdrone-sot", "dtb70")


@pytest.mark.parametrize("name", SINGLE)
def test_an_export_has_the_figures_of_its_recording(flights, tmp_path, name):
    export(load(flights), name, tmp_path / name, ExportOptions())
    theirs = run(Scoring("stay", tmp_path / name), tmp_path / "theirs", workers=1)
    ours = run(Scoring("stay", flights), tmp_path / "ours", workers=1)
    assert theirs["all"] == ours["all"]
    assert theirs["published"] == ours["published"]
    assert theirs["strata"]["size"] == ours["strata"]["size"]


@pytest.mark.parametrize("name", ["mot", "uavdt", "visdrone-mot"])
def test_of_many_objects_each_is_a_sequence(flights, tmp_path, name):
    export(load(flights), name, tmp_path / name, ExportOptions())
    found = sequences_in(tmp_path / name)
    assert len(found) > 1
    assert all(len(each) >= 25 and each.visible.sum() >= 25 for each in found)
    from_one = int(name == "mot")  # pixels counted from 1 stay as they are
    for episode in load(flights):
        labels = {
            (each.label["id"], frame.number): left_top_width_height(each.label["box"])
            for frame in episode
            for each in objects_of(frame.label)
        }
        for sequence in found:
            if sequence.name.startswith(f"{episode.name}-"):
                number = sequence.truth.first
                left, top, *_ = labels[int(sequence.truth.name), number]
                assert sequence.boxes[0, :2].tolist() == [left + from_one, top + from_one]


def pictures(folder, count, name="{:04d}.jpg", first=1):
    folder.mkdir(parents=True)
    for number in range(first, first + count):
        pixels = np.full((24, 32, 3), 8 * number % 256, np.uint8)
        Image.fromarray(pixels).save(folder / name.format(number))


def test_pictures_are_in_the_order_of_their_numbers(tmp_path):
    pictures(tmp_path / "img", 12, "{}.png")
    (tmp_path / "groundtruth.txt").write_text("1,1,4,4\n" * 12)
    (found,) = sequences_in(tmp_path)
    assert [path.name for path in found.files] == [f"{number}.png" for number in range(1, 13)]
    assert [int(each[0, 0, 0]) for each in found.pictures()] == [8 * n for n in range(1, 13)]


def test_otb_s_david_begins_at_picture_300(tmp_path):
    pictures(tmp_path / "David/img", 310)
    (tmp_path / "David/groundtruth_rect.txt").write_text("1\t2\t3\t4\n" * 11)
    (found,) = sequences_in(tmp_path)
    assert (found.files[0].name, len(found)) == ("0300.jpg", 11)


def test_parts_of_uav123_are_cut_by_its_list(tmp_path):
    pictures(tmp_path / "data_seq/UAV123/car1", 20, "{:06d}.jpg")
    anno = tmp_path / "anno/UAV123"
    anno.mkdir(parents=True)
    (anno / "car1_2.txt").write_text("5,5,4,4\n" * 5)
    (tmp_path / "configSeqs.m").write_text(
        "seqs={struct('name','car1_2','path','..\\data_seq\\UAV123\\car1\\',"
        "'startFrame',11,'endFrame',15,'nz',6,'ext','jpg'),...};"
    )
    (found,) = sequences_in(tmp_path)
    assert [path.stem for path in found.files] == [f"{n:06d}" for n in range(11, 16)]


def test_two_objects_of_one_folder_are_two_sequences(tmp_path):
    pictures(tmp_path / "Jogging/img", 5)
    for number in (1, 2):
        text = f"{number},2,3,4\n" * 5
        (tmp_path / f"Jogging/groundtruth_rect.{number}.txt").write_text(text)
    assert [each.name for each in sequences_in(tmp_path)] == ["Jogging-1", "Jogging-2"]


@pytest.mark.parametrize(
    ("row", "box"),
    [
        ("1.5,2,3,4", [1.5, 2, 3, 4]),
        ("1 2\t3 4", [1, 2, 3, 4]),
        ("10,5,20,5,20,15,10,15", [10, 5, 10, 10]),
        ("m3,4,3,2,1,1,2,2", [4, 4, 2, 2]),
        ("nan,nan,nan,nan", [np.nan] * 4),
        ("1", [np.nan] * 4),
    ],
)
def test_rows_are_read_in_each_form(tmp_path, row, box):
    path = tmp_path / "groundtruth.txt"
    path.write_text(f"{row}\n1,1,2,2\n")
    (truth,) = read_truth(path)
    np.testing.assert_array_equal(truth.boxes[0], box)


def test_hidden_frames_do_not_count(tmp_path):
    pictures(tmp_path / "img", 4)
    (tmp_path / "groundtruth.txt").write_text("1,1,4,4\n1,1,4,4\nnan,nan,nan,nan\n0,0,0,0\n")
    (tmp_path / "full_occlusion.txt").write_text("0,1,0,0")
    (found,) = sequences_in(tmp_path)
    assert found.visible.tolist() == [True, False, False, False]


def test_of_one_box_all_pictures_are_tracked_and_none_scored(tmp_path):
    pictures(tmp_path / "t/GOT-10k_Test_000001", 6, "{:08d}.jpg")
    (tmp_path / "t/GOT-10k_Test_000001/groundtruth.txt").write_text("1,1,8,8\n")
    results = run(Scoring("stay", tmp_path / "t"), tmp_path / "out", workers=1)
    assert results["all"] == {"frames": 0}
    rows = (tmp_path / "out/boxes/GOT-10k_Test_000001.txt").read_text().splitlines()
    assert len(rows) == 7


def film_in(folder):
    av = pytest.importorskip("av")
    with av.open(str(folder / "film.mp4"), "w") as container:
        stream = container.add_stream("mpeg4", rate=10)
        stream.width, stream.height = 64, 48
        for number in range(30):
            pixels = np.full((48, 64, 3), 4 * number, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(pixels)))
        container.mux(stream.encode())
    return folder / "film.mp4"


def test_by_a_box_alone_boxes_and_a_film_are_made_and_no_table(tmp_path, eyas_command):
    film = film_in(tmp_path)
    pictures(tmp_path / "shots", 5)
    words = ["--tracker", "stay", "--box", "20,10,16,12", "--workers", "1", "--out"]
    done = eyas_command("track", film, *words, tmp_path / "of-film")
    assert done.returncode == 0, done.stderr
    assert "no true boxes, so no figures" in done.stdout
    assert "a box in 29 of 29 frames" in done.stdout
    assert "AO" not in done.stdout
    (drawn,) = sequences_in(tmp_path / "of-film/films/film.mp4", box=(20.0, 10.0, 16.0, 12.0))
    assert (len(drawn), drawn.size, drawn.fps) == (30, (64, 48), 10.0)
    for picture in list(drawn.pictures())[::10]:
        around = picture[10, 22:34].astype(int)  # the upper edge of the box: yellow
        assert (around[:, 0] - around[:, 2]).min() > 60
        assert np.ptp(picture[13:19, 24:32].astype(int)) < 40  # grey inside
    done = eyas_command("track", tmp_path / "shots", *words, tmp_path / "of-shots")
    assert "a box in 4 of 4 frames" in done.stdout
    assert str(tmp_path / "of-shots/films/shots") in done.stdout


def test_a_film_is_tracked_by_a_box_or_by_a_file(tmp_path):
    film = film_in(tmp_path)
    (by_box,) = sequences_in(film, box=(1.0, 1.0, 9.0, 9.0))
    assert (len(by_box), by_box.size, by_box.fps) == (30, (64, 48), 10.0)
    (tmp_path / "gt.txt").write_text("".join(f"{n},7,1,1,9,9,1,-1,-1,-1\n" for n in range(3, 29)))
    (by_file,) = sequences_in(film, truth=tmp_path / "gt.txt")
    levels = [int(each.mean()) for each in by_file.pictures()]
    assert (len(levels), by_file.name) == (26, "film-7")
    assert abs(levels[0] - 8) <= 3
    with pytest.raises(EyasError, match="--truth or --box is needed"):
        sequences_in(film)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("left,top,width,height\n", "line 1: 'left,top,width,height' is not a box"),
        ("", "has no boxes"),
        ("1,2,3,1e99\n", "beyond 10,000,000 pixels"),
        ("m1,2,99999,99999,5\n", "not a mask of VOT"),
        ("m1,2,3,3,5,-2,9\n", "not a mask of VOT"),
    ],
)
def test_a_damaged_file_is_one_line(tmp_path, content, told):
    pictures(tmp_path / "img", 3)
    (tmp_path / "groundtruth.txt").write_text(content)
    with pytest.raises(EyasError) as error:
        sequences_in(tmp_path)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_pictures_without_boxes_and_nothing_at_all_are_one_line(tmp_path):
    pictures(tmp_path / "some/img", 3)
    with pytest.raises(EyasError, match="no boxes beside them"):
        sequences_in(tmp_path / "some")
    (tmp_path / "none").mkdir()
    with pytest.raises(EyasError, match="nor a folder of sequences"):
        sequences_in(tmp_path / "none")


def test_a_few_of_many_are_chosen_by_name(tmp_path):
    for name in ("car1", "car2", "bike1"):
        pictures(tmp_path / f"s/{name}/img", 3)
        (tmp_path / f"s/{name}/groundtruth.txt").write_text("1,1,4,4\n" * 3)
    results = run(Scoring("stay", tmp_path / "s", only="car*"), tmp_path / "out", workers=1)
    assert sorted(results["episodes"]) == ["car1", "car2"]
    with pytest.raises(EyasError, match="--only: 'cr1'"):
        run(Scoring("stay", tmp_path / "s", only="cr1"), tmp_path / "no", workers=1)
    with pytest.raises(EyasError, match="--box"):
        parsed_box("1,2,0,4")
    shutil.rmtree(tmp_path / "s/car1/img")
    assert [each.name for each in sequences_in(tmp_path / "s")] == ["bike1", "car2"]


def test_an_offline_evaluation_is_the_same_run(tmp_path, eyas_command):
    pictures(tmp_path / "s" / "img", 12)
    (tmp_path / "s" / "groundtruth_rect.txt").write_text("4,4,8,8\n" * 12)
    words = {
        "track": ["track", tmp_path / "s", "--tracker", "stay"],
        "offline": ["evaluate", "--offline", tmp_path / "s", "--policy", "stay"],
        "equals": ["evaluate", f"--offline={tmp_path / 's'}", "--policy", "stay"],
    }
    done = {
        name: eyas_command(*line, "--workers", "1", "--out", tmp_path / name)
        for name, line in words.items()
    }
    assert all(one.returncode == 0 for one in done.values()), done["offline"].stderr
    told = {name: one.stdout.replace(str(tmp_path / name), "") for name, one in done.items()}
    assert told["track"] == told["offline"] == told["equals"]
