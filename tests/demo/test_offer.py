"""What the menus offer of the user's own files, and what they leave out."""

import json

import pytest

from eyas.benchmark.policies.shipped import file_of
from eyas.demo.choices import WorldChoice, choice_of, chosen_in
from eyas.demo.messages import WorldMessage
from eyas.demo.offer import Offer, words_of
from eyas.demo.readings import readings
from eyas.engine.core.config import updated
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.settings.config import EyasConfig

BOX = """<robot name="fox"><link name="a"><visual><geometry><box size="1 0.5 0.5"/></geometry>
<material name="m"><color rgba="0.9 0.4 0.1 1"/></material></visual></link></robot>"""
AGENT = {"url": "http://localhost:1/v1", "model": "m"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for path, content in {
        "targets/delivery_fox.urdf": BOX.encode(),
        "targets/readme.txt": b"x",
        "mine.onnx": file_of("fast").read_bytes(),
        "runs/ppo/policy.onnx": file_of("fast").read_bytes(),
        "runs/ppo/checkpoint.pt": b"x",
        "agent.json": json.dumps(AGENT).encode(),
        "package.json": b'{"name": "x"}',
        "broken.json": b"{",
        "evil.zip": b"PK",
        "broken.plan.json": b"{",
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes(content)
    return tmp_path


def test_networks_and_agents_are_offered_and_files_that_may_run_code_are_not(folder):
    offer = Offer.of(EyasConfig(), "evil:Policy")
    shipped = Offer.of(EyasConfig(), folder=folder / "targets").policies
    own = ["mine.onnx", "runs/ppo/policy.onnx", "agent.json", "evil:Policy"]
    assert [*offer.policies] == [*shipped, *own]
    assert "broken.plan.json" not in offer.maps


def test_an_own_map_is_offered_by_its_title(folder, caplog):
    plan = {"format": "eyas-plan-1", "name": "yard", "title": "Our yard"}
    (folder / "yard.plan.json").write_text(json.dumps(plan))
    offer = Offer.of(EyasConfig())
    assert offer.maps["yard.plan.json"] == "Our yard"
    chosen = choice_of(
        WorldChoice(EyasConfig(), 40), WorldMessage(map="yard.plan.json", weather="day"), offer
    )
    assert chosen.config.world.map == "yard.plan.json"


@pytest.mark.slow
def test_an_own_target_is_followed_and_called_by_its_name(folder):
    base = updated(EyasConfig(), {"world": {"map": "simpleway-grass"}})
    offer, before = Offer.of(base), WorldChoice(base, 40)
    name = "targets/delivery_fox.urdf"
    assert words_of(name) == "delivery fox"
    own = choice_of(before, WorldMessage(target=name), offer)
    assert chosen_in(own, offer)["target"] == name
    assert readings(own.build())["target"]["words"] == "a delivery fox"
    assert (
        chosen_in(choice_of(own, WorldMessage(target="Pedestrian"), offer), offer)["target"]
        == "Pedestrian"
    )
    with pytest.raises(UnknownNameError):
        choice_of(before, WorldMessage(target="targets/../../x.urdf"), offer)


def test_targets_are_in_words(folder):
    assert words_of("SUMO_VEHICLE") == "cars and more"
    assert words_of("AiboErs7") == "a white robot puppy with a black face"


def test_the_target_of_the_settings_can_be_chosen_again(folder):
    config = updated(EyasConfig(), {"custom": {"body": "Pedestrian", "behaviour": "wander"}})
    offer, world = Offer.of(config), WorldChoice(config, 40)
    assert chosen_in(world, offer)["target"] == "custom"
    cars = choice_of(world, WorldMessage(target="SUMO_VEHICLE"), offer)
    assert cars.config.custom is None
    assert choice_of(cars, WorldMessage(target="custom"), offer).config.custom == config.custom
