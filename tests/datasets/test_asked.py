"""What the command line asks for instead of what a recipe has."""

import pytest

from eyas.datasets.asked import Asked
from eyas.datasets.plan import planned
from eyas.datasets.recipe import read_recipe
from eyas.engine.core.config import updated
from eyas.engine.core.errors import EyasError
from eyas.engine.targets.config import TargetName
from eyas.engine.traffic.library import CANONICAL_MIX

DETECT = read_recipe("detect")


def test_what_is_not_asked_for_stays():
    assert Asked().of(DETECT) == DETECT


def test_buses_in_rain_at_dusk_are_followed_where_recorded_traffic_has_them():
    asked = Asked(2000, classes=("bus",), weathers=("rain", "dusk"), formats=("yolo", "coco"))
    recipe = asked.of(DETECT)
    parts = planned(recipe)
    assert sum(part.frames for part in parts) == 2000
    assert {part.config.world.map for part in parts} == {"citystreet", "downtown"}
    assert {part.config.world.weather for part in parts} == {"rain", "dusk"}
    for part in parts:
        assert part.config.start.vehicles == ("bus",)
        assert part.config.traffic.vehicle_type == CANONICAL_MIX
        assert part.config.video.channels <= 4  # as many buses as there are
    assert recipe.formats == ("coco", "yolo")
    assert sum(split.share for split in recipe.splits.given.values()) == pytest.approx(1.0)
    assert recipe.about == (
        "Made by the recipe eyas-detect, but with classes bus; weathers rain, dusk; formats yolo, "
        "coco. No map is left for val, which has other episodes of the maps of train."
    )


def test_where_no_map_is_left_val_has_other_episodes_at_other_times():
    recipe = Asked(2000, classes=("bus",)).of(DETECT)
    parts = planned(recipe)
    own = {
        split: [part for part in parts if part.split == split and part.config.world.map == name]
        for split, name in (("train", "citystreet"), ("val", "citystreet"), ("test", "downtown"))
    }
    assert all(own.values())
    latest = max(part.config.video.start_time for part in own["train"])
    assert latest < min(part.config.video.start_time for part in own["val"])
    assert not Asked(2000).of(DETECT).shared_places
    with pytest.raises(EyasError, match="no place may be in two splits"):
        planned(updated(recipe, {"shared_places": False}))


def test_people_and_vehicles_take_turns():
    recipe = Asked(classes=("person", "truck"), maps=("citystreet", "downtown")).of(DETECT)
    followed = {(part.config.target, part.config.start.vehicles) for part in planned(recipe)}
    assert followed == {(TargetName.PEDESTRIAN, None), (TargetName.SUMO_VEHICLE, ("truck",))}


def test_settings_win_over_those_of_a_map():
    recipe = Asked(settings=("video.jpeg_quality=50", "traffic.max_vehicles=12")).of(DETECT)
    for part in planned(recipe):
        assert part.config.video.jpeg_quality == 50
        assert part.config.traffic.max_vehicles == 12


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        (Asked(classes=("buss",)), "--classes: 'buss' is not allowed; did you mean 'bus'?"),
        (Asked(classes=("bus",), maps=("lake",)), "--classes: on lake no recorded traffic has bus"),
        (Asked(maps=("lak",)), "--map: 'lak' is not allowed in the splits; did you mean 'lake'?"),
        (Asked(formats=("yollo",)), "--format: 'yollo' is not allowed; did you mean 'yolo'?"),
        (Asked(settings=("video.jpg=1",)), "factors.set.video.jpg: unknown key"),
        (Asked(settings=("video",)), "--set 'video': not of the form key=value"),
        (Asked(weathers=("rainy",)), "splits.train.maps.0: world.weather: 'rainy'"),
    ],
)
def test_what_is_wrong_is_one_line(asked, line):
    with pytest.raises(EyasError) as caught:
        planned(asked.of(DETECT))
    assert str(caught.value).startswith(line)
    assert "\n" not in str(caught.value)
