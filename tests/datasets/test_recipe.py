"""Recipes: what is wrong with one is told in a line, before anything is built."""

import json
from itertools import pairwise

import pytest

from eyas.datasets.plan import in_order_of_work, planned, sample_of, shard_of
from eyas.datasets.recipe import SHIPPED, SPLITS, Recipe, read_recipe
from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError, DataFileError, EyasError

BASE = {
    "name": "some",
    "title": "Some",
    "frames": 800,
    "episode_frames": 20,
    "trackers": 4,
    "splits": {
        "train": {"share": 0.8, "maps": ["citystreet", "village"]},
        "test": {"share": 0.2, "maps": ["downtown"]},
    },
    "weathers": ["day", "snow"],
    "heights": [10.0, 20.0, {"uniform": [15.0, 30.0]}],
}


def changed(**changes):
    return validated(Recipe, {**BASE, **changes})


@pytest.mark.parametrize("name", SHIPPED)
def test_those_that_ship_can_be_planned(name):
    recipe = read_recipe(name)
    parts = planned(recipe)
    assert sum(part.frames for part in parts) == recipe.frames
    check_splits(parts)
    sample = sample_of(recipe)
    few = planned(sample)
    assert sum(part.frames for part in few) == sample.frames < recipe.frames / 20
    maps = {(part.split, part.config.world.map) for part in few}
    assert maps == {(part.split, part.config.world.map) for part in parts}


def check_splits(parts):
    for of in (lambda part: part.config.seed, lambda part: part.config.world.map):
        found = {name: {of(part) for part in parts if part.split == name} for name in SPLITS}
        assert len(set.union(*found.values())) == sum(map(len, found.values()))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"frame": 3}, "frame: unknown key; did you mean 'frames'?"),
        ({"targets": ["Pedestrain"]}, "targets: .*Pedestrain"),
        ({"weathers": ["foggie"]}, r"splits\.train\.maps\.0: .*'foggie'.*did you mean 'foggy'"),
        ({"weathers": []}, "weathers: .*at least one value"),
        ({"weathers": ["day", "day"]}, "weathers: .*none twice"),
        ({"writers": ["jpeg"]}, "writers: .*must hold 'labels'"),
        ({"writers": ["labels", "jpg"]}, r"'jpg'.*did you mean 'jpeg'"),
        ({"formats": ["cocoa"]}, r"'cocoa'.*did you mean 'coco'"),
        ({"formats": ["coco"]}, "writers: the format 'coco' needs 'masks'"),
        ({"frames": 810}, "frames: 810 is not allowed: .* such as 800 or 820"),
        ({"frames": 40}, r"splits\.train: 2 episodes make 1 parts .* its 2 maps; allowed"),
        ({"trackers": 41, "frames": 40000}, "trackers: 41 is not allowed: .* 40 vehicles"),
        ({"episode_frames": 40000, "frames": 320000, "trackers": 1}, "episode_frames: .* traffic"),
        ({"settings": {"camera": {"widht": 3}}}, r"settings\.camera\.widht: unknown key"),
        ({"factors": {"rain": [{"wold": {}}]}}, r"factors\.rain\.wold: unknown key"),
        ({"places": {"vilage": {}}}, "places: 'vilage'.*did you mean 'village'"),
        ({"heights": [-5.0]}, "start.height: -5"),
        ({"licence": "cc"}, "licence: 'cc'"),
    ],
)
def test_what_cannot_be_met_is_one_line(changes, said):
    with pytest.raises(EyasError, match=said) as raised:
        planned(changed(**changes))
    assert "\n" not in str(raised.value)


def test_no_place_is_in_two_splits():
    def splits(train, test):
        return {"train": {"share": 0.8, "maps": train}, "test": {"share": 0.2, "maps": test}}

    with pytest.raises(ConfigError, match=r"splits\.test\.maps: 'lake' is in the split 'train'"):
        planned(changed(splits=splits(["lake"], ["downtown", "lake"])))
    # The same roads under another skin are the same place.
    with pytest.raises(ConfigError, match="'village-bare' has the roads of 'village'"):
        planned(changed(splits=splits(["village"], ["village-bare"]), weathers=["day"]))
    with pytest.raises(ConfigError, match="'simpleway-lake' has the roads of 'simpleway-grass'"):
        planned(changed(splits=splits(["simpleway-grass"], ["simpleway-lake"])))


def test_shares_must_add_up():
    with pytest.raises(ConfigError, match=r"splits.*add up to 1, not 0\.8"):
        changed(splits={"train": {"share": 0.8, "maps": ["lake"]}})


def test_values_come_equally_often_and_parts_begin_at_different_times():
    parts = planned(changed(frames=8000))
    train = [part for part in parts if part.split == "train"]
    assert len(train) == 80
    for key, values in (("weather", 2), ("map", 2)):
        found = [getattr(part.config.world, key) for part in train]
        assert {found.count(value) for value in found} == {80 // values}
    heights = [str(part.config.start.height) for part in train]
    assert {heights.count(height) for height in heights} <= {26, 27}
    for name in ("citystreet", "village"):
        times = [each.config.start.warm_up_steps for each in train if each.config.world.map == name]
        assert len(set(times)) == len(times)


def test_no_episode_of_a_part_ends_before_its_time():
    for part in planned(changed(frames=8000)):
        done = part.config.done
        assert done.grace_steps == min(100, done.total_steps)


def test_variants_have_the_same_seed_and_time():
    parts = planned(changed(variants={"clean": {}, "late": {"control": {"frequency": 50.0}}}))
    for clean, late in zip(parts[::2], parts[1::2], strict=True):
        assert (clean.variant, late.variant) == ("clean", "late")
        assert clean.number == late.number
        assert clean.config.start == late.config.start
        assert clean.config.seed == late.config.seed
        assert late.config.control.frequency == 50.0


def test_shards_share_all_parts_out():
    parts = planned(changed(frames=8000, variants={"a": {}, "b": {}}))
    for count in (1, 3, 7):
        shards = [shard_of(parts, number, count) for number in range(1, count + 1)]
        names = [part.name for shard in shards for part in shard]
        assert sorted(names) == sorted(part.name for part in parts)
        assert max(map(len, shards)) - min(map(len, shards)) <= 2  # the variants of one
    with pytest.raises(ConfigError, match=r"--shard: '1/51' is not allowed: .* at most 50"):
        shard_of(parts, 1, 51)


def test_work_is_done_map_by_map():
    maps = [part.config.world.map for part in in_order_of_work(planned(changed(frames=8000)))]
    assert sum(one != two for one, two in pairwise(maps)) == 2


def test_files_are_read_with_their_names_in_errors(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({**BASE, "fps": "fast"}))
    with pytest.raises(ConfigError, match=r"mine\.json: fps: 'fast' is not allowed"):
        read_recipe(str(path))
    path.write_text("{")
    with pytest.raises(DataFileError, match=r"mine\.json: line 1"):
        read_recipe(str(path))
    with pytest.raises(ConfigError, match=r"RECIPE: 'detekt'.*did you mean 'detect'"):
        read_recipe("detekt")


@pytest.mark.parametrize(
    "changes",
    [
        {"writers": ["labels", "my_package.module:Writer"]},
        {"formats": ["my_package.module:Format"]},
        {"settings": {"tracker": {"kind": "my_package.module:Tracker"}}},
        {"factors": {"kind": [{"tracker": {"kind": "my_package.module:Tracker"}}]}},
        {"splits": {"train": {"share": 1.0, "maps": ["my_package.module:MAP"]}}},
    ],
)
def test_files_that_name_code_must_be_trusted(changes, tmp_path):
    path = tmp_path / "theirs.json"
    path.write_text(json.dumps({**BASE, **changes}))
    with pytest.raises(ConfigError, match=r"this file would run code: 'my_package\.module:"):
        read_recipe(str(path))
    read_recipe(str(path), trust=True)
