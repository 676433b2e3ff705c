"""What the commands do, called from Python by the public names."""

import json

import pytest

import eyas


def test_an_environment_is_made_by_map_and_weather():
    env = eyas.make("simpleway-grass-foggy", action_repeat=4)
    assert env.unwrapped.config.world.weather == "foggy"
    assert env.unwrapped.config.env.action_repeat == 4
    envs = eyas.make_vec("simpleway-grass-day", num_envs=3)
    assert envs.reset(seed=0)[0].shape[0] == 3
    env.close()
    envs.close()


def test_settings_are_of_a_preset_changed_by_keywords():
    config = eyas.make_config("easy", map="lake", target="BB-8")
    assert (config.world.map, config.target) == ("lake", "BB-8")
    with pytest.raises(eyas.ConfigError, match=r"keyword: .*'maps'.*map"):
        eyas.make_config(maps="lake")


def test_a_recording_is_made_and_read(tmp_path):
    short = {"video": {"total_time": 0.2, "channels": 1, "writers": ["labels"]}}
    folder = eyas.record(short, tmp_path / "out", map="simpleway-grass")
    labels = eyas.read_labels(folder / "DRONE0/episode0/labels.jsonl")
    assert [label["frame"] for label in labels] == [*range(len(labels))]
    assert json.loads((folder / "version.json").read_text())["build_id"] == eyas.build_id


def test_a_policy_is_evaluated(tmp_path):
    records = eyas.evaluate("hover", "paper", tmp_path, map="simpleway-grass", episodes=1)
    assert len(records) == 4  # one for each start direction
    assert {record.map for record in records} == {"simpleway-grass"}


def test_a_keyword_that_evaluate_does_not_have_is_told_with_the_nearest():
    with pytest.raises(eyas.UnknownNameError, match=r"keyword: 'maps' .* did you mean 'map'"):
        eyas.evaluate("hover", maps=["lake"])


def test_the_lists_name_what_the_settings_take():
    assert "citystreet" in eyas.list_maps()
    assert {"day", "foggy", "night", "snow"} <= set(eyas.list_weathers("downtown"))
    assert "Pedestrian" in eyas.list_targets()
    assert {"servo", "fast"} <= set(eyas.list_policies())
    assert "dat-train" in eyas.list_presets()


def test_a_result_tells_the_build(tmp_path):
    eyas.evaluate("hover", "paper", tmp_path, map="simpleway-grass", episodes=1)
    assert json.loads((tmp_path / "result.json").read_text())["build_id"] == eyas.build_id
