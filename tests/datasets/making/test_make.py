"""Data sets are the same to the byte however they are made: killed, in shards, on many cores."""

import json
import shutil
import subprocess
import time

import pytest

import eyas
from eyas.datasets.layout import Plan, write_plan
from eyas.datasets.making.make import Making, make
from eyas.datasets.making.merge import merge
from eyas.datasets.making.run import run
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.core.folder_lock import folder_lock

pytestmark = pytest.mark.slow  # what its tests share takes long to make


def test_a_killed_one_is_continued_to_the_same_bytes(
    recipe_file, plan, made, contents, start, tmp_path
):
    out = tmp_path / "killed"
    process = start("make", recipe_file, "--out", out, "--workers", "2")
    until = time.monotonic() + 300
    while not list(out.glob("parts/*/*/part.json")):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)
    process.kill()
    process.communicate()
    assert not (out / "dataset.json").exists()
    with pytest.raises(DataFileError, match="not a recording"):
        eyas.load(out)
    make(plan, out, Making(resume=True, workers=1))
    assert contents(out) == contents(made)


def test_one_that_is_complete_is_left_alone(plan, made, contents):
    before = contents(made)
    make(plan, made, Making(resume=True))
    assert contents(made) == before


def test_one_that_was_damaged_is_mended(plan, made, contents, tmp_path, caplog):
    out = shutil.copytree(made, tmp_path / "damaged")
    before = contents(out)
    label = sorted(out.glob("parts/*/*/*/episode0/labels.jsonl"))[0]
    exported = next(path for path in sorted(out.glob("exports/*/**/*.*")) if path.is_file())
    for path in (out / "README.md", label, exported):
        content = path.read_bytes()[:100]
        path.unlink()  # it may be a link
        path.write_bytes(content)
    make(plan, out, Making(resume=True, workers=1))
    assert contents(out) == before
    assert "README.md: not as it was made (3 such files)" in caplog.text


@pytest.fixture(scope="module")
def shards(shard, tmp_path_factory):
    folders = [tmp_path_factory.mktemp("shards") / f"shard{number}" for number in (1, 2, 3)]
    for number, folder in enumerate(folders, 1):
        make(shard(number, 3), folder, Making(workers=1))
    return folders


def test_shards_join_to_the_whole(shards, made, contents, tmp_path):
    merge([shards[2], shards[0], shards[1]], tmp_path / "whole", Making(workers=1))
    assert contents(tmp_path / "whole") == contents(made)


def test_shards_that_are_missing_there_twice_or_damaged_are_refused(shards, made, tmp_path):
    with pytest.raises(DataFileError, match=r"1 of 3 shards are missing: 2"):
        merge([shards[0], shards[2]], tmp_path / "no", Making())
    with pytest.raises(DataFileError, match=r"shard 1 of 3, as .*shard1 is, too"):
        merge([shards[0], shards[0]], tmp_path / "no", Making())
    with pytest.raises(DataFileError, match="not a shard, but a whole data set"):
        merge([made], tmp_path / "no", Making())
    picture = next(shards[1].rglob("000000.jpeg"))
    content = picture.read_bytes()
    picture.unlink()  # a link to it is in the data set
    picture.write_bytes(content[:-1] + b"!")
    with pytest.raises(DataFileError, match=r"000000\.jpeg: not what was recorded"):
        merge(shards, tmp_path / "no", Making())
    assert not (tmp_path / "no" / "dataset.json").exists()
    picture.write_bytes(content)


def test_shards_of_other_recipes_are_refused(plan, shards, tmp_path):
    other = plan.recipe.model_copy(update={"seed": 8})
    theirs = tmp_path / "theirs"
    shutil.copytree(shards[1], theirs)
    (theirs / "dataset.json").unlink()
    write_plan(theirs, Plan.of(other, "own.json", sample=False, shard=(2, 3)))
    (theirs / "making.json").rename(theirs / "dataset.json")
    with pytest.raises(
        DataFileError, match=r"not of the same data set .* recipe\.seed was 7, is 8"
    ):
        merge([shards[0], theirs], tmp_path / "out", Making())


@pytest.mark.thorough  # as `test_video_broken_off`, of the same writers
def test_a_full_disk_is_one_line_and_can_be_continued(recipe_file, made, contents, start, tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("disks of a given size are only for root")
    try:
        process = start("make", recipe_file, "--out", disk / "out", "--workers", "2")
        said = process.communicate()[1]
        assert (process.returncode, said.count("\n")) == (2, 1), said
        assert "cannot write: No space left on device" in said
        assert said.endswith("; continue with --resume\n")
        subprocess.run(["mount", "-o", "remount,size=100m", str(disk)], check=True)
        again = start("make", recipe_file, "--out", disk / "out", "--resume", "--quiet")
        assert again.communicate() == ("", "")
        assert contents(disk / "out") == contents(made)
    finally:
        subprocess.run(["umount", "-l", str(disk)], check=True)


def test_two_at_once_in_one_folder_are_refused(plan, tmp_path):
    with (
        folder_lock(tmp_path, "making a data set in it"),
        pytest.raises(OutputError, match="is making a data set in it"),
    ):
        make(plan, tmp_path, Making(workers=1))
    assert list(tmp_path.iterdir()) == []


def test_folders_that_hold_something_else_are_refused(plan, made, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="not empty; continue its data set with --resume"):
        make(plan, tmp_path, Making())
    with pytest.raises(OutputError, match=r"not a data set: it has no making\.json"):
        make(plan, tmp_path, Making(resume=True))
    other = plan.model_copy(update={"recipe": plan.recipe.model_copy(update={"fps": 5.0})})
    with pytest.raises(OutputError, match=r"not continued: recipe\.fps was 10\.0, is 5\.0"):
        make(other, made, Making(resume=True))


def test_worlds_that_cannot_be_are_told_before_anything_is_drawn(plan, tmp_path):
    behaviour = {"kind": "Pedestrian", "count": 3, "behaviour": "pavement"}
    recipe = plan.recipe.model_validate(
        {**plan.recipe.model_dump(), "places": {"simpleway-grass": {"extras": [behaviour]}}}
    )
    wrong = Plan.of(recipe, "own.json", sample=False, shard=None)
    with pytest.raises(eyas.EyasError, match=r"00002-simpleway-grass-.*has no pavement"):
        make(wrong, tmp_path / "out", Making(workers=2))
    assert not (tmp_path / "out").exists()


def test_flights_that_do_not_exist_are_refused(tiny, tmp_path):
    path = tmp_path / "own.json"
    path.write_text(json.dumps({**tiny, "flights": ["orbitt"]}))
    with pytest.raises(ConfigError, match=r"'orbitt'.*did you mean 'orbit'"):
        run(str(path), str(tmp_path / "out"), Making())
    assert not (tmp_path / "out").exists()


def test_an_interrupt_is_one_line(recipe_file, start, tmp_path):
    process = start("make", recipe_file, "--out", tmp_path / "out", "--workers", "2")
    until = time.monotonic() + 300
    while not (tmp_path / "out" / "making.json").exists():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)
    process.send_signal(subprocess.signal.SIGINT)
    said = process.communicate()[1]
    assert process.returncode == 130
    assert said.splitlines()[-1].startswith("eyas: interrupted; every file in ")
    assert len(said.splitlines()) == 1


def test_variants_show_the_same_world(plan, tmp_path):
    changes = {
        "frames": 12,
        "trackers": 1,
        "splits": {"train": {"share": 1.0, "maps": ["citystreet"]}},
        "variants": {"clean": {}, "wide": {"camera": {"field_of_view": 1.5}}},
        "cameras": [{"width": 64, "height": 48}],
        "formats": [],
    }
    recipe = plan.recipe.model_validate({**plan.recipe.model_dump(), **changes})
    make(Plan.of(recipe, "own.json", sample=False, shard=None), tmp_path / "d", Making(workers=1))
    clean, wide = eyas.load(tmp_path / "d")
    assert [clean.name.split("-")[3], wide.name.split("-")[3]] == ["clean", "wide"]
    for one, two in zip(clean.labels, wide.labels, strict=True):
        for key in ("time", "target_position", "target_type", "target_id"):
            assert one[key] == two[key]
        assert one["field_of_view"] != two["field_of_view"]


def test_python_makes_them_too(tiny, tmp_path):
    short = {"frames": 2, "episode_frames": 2, "trackers": 1, "formats": []}
    own = {**tiny, **short, "splits": {"val": {"share": 1.0, "maps": ["simpleway-grass"]}}}
    folder = eyas.make_dataset(own, tmp_path / "out", workers=1)
    assert [len(episode) for episode in eyas.load(folder)] == [2]
    with pytest.raises(ConfigError, match=r"keyword: 'worker' .* did you mean 'workers'"):
        eyas.make_dataset(own, tmp_path / "out", worker=1)
