"""Films by a link: the same bytes after other flights, by the command, and as recorded."""

import re
from functools import partial

import numpy as np
import pytest
from PIL import Image

from eyas.demo import messages as said
from eyas.demo.choices import WorldChoice, choice_of
from eyas.demo.film import SIZE, STEPS, begun, flown, link_of, read_link
from eyas.demo.offer import Offer
from eyas.demo.orders import carry_out, end_film, enter_new_world
from eyas.demo.recording import DemoRecording
from eyas.demo.session import Session
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.settings.config import EyasConfig

OFFER = Offer.of(EyasConfig())
USUAL = WorldChoice(EyasConfig(), EyasConfig().traffic.max_vehicles)
GRASS = choice_of(USUAL, said.WorldMessage(map="simpleway-grass"), OFFER)
LINK = link_of(GRASS, "servo", 4711, OFFER)


def test_a_link_has_forty_characters():
    assert re.fullmatch(
        r"citystreet/day/fast/4711/[0-9a-f]{8}", link_of(USUAL, "fast", 4711, OFFER).text
    )
    assert len(link_of(USUAL, "follow", 99_999, OFFER).text) <= 40


def test_what_the_menus_choose_is_in_the_link():
    wish = said.WorldMessage(
        map="lake",
        weather="dusk",
        target="Pedestrian",
        tracker="flown",
        light="dim",
        hour=19.5,
        people=10,
        vehicles=10,
    )
    world = choice_of(USUAL, wish, OFFER)
    film = link_of(world, "follow", 3, OFFER)
    assert read_link(f"http://127.0.0.1:8720/?token=x#{film.text}", OFFER) == film
    assert film.choice == world


@pytest.mark.parametrize(
    "text",
    [
        "",
        "x" * 100_000,
        "/" * 200,
        "../day/servo/1/HERE",
        "%2e%2e/day/servo/1/HERE",
        "os:abort/day/servo/1/HERE",
        "/tmp/day/servo/1/HERE",
        "simpleway-grass/day/servo/-1/HERE",
        "simpleway-grass/day/servo/1e9/HERE",
        "simpleway-grass/day/servo/9999999999999999999/HERE",
        "simpleway-grass/day/servo/٣/HERE",
        "simpleway-grass/dayy/servo/1/HERE",
        "simpleway-gras/day/servo/1/HERE",
        "simpleway-grass~1a2b3c4d/day/servo/1/HERE",
        "simpleway-grass/day/~1a2b3c4d/1/HERE",
        "simpleway-grass/day/boxes/1/HERE",
        "simpleway-grass/day/servo/1/00000000",
        "simpleway-grass/day/servo/1/HERE/map=lake",
        "simpleway-grass/day/servo/1/HERE/vehicles=1e9",
        "simpleway-grass/day/servo/1/HERE/vehicles=999",
        "simpleway-grass/day/servo/1/HERE/vehicles=0.5",
        "simpleway-grass/day/servo/1/HERE/hour=nan",
        "simpleway-grass/day/servo/1/HERE/hour=25",
        "simpleway-grass/day/servo/1/HERE/target=custom",
        "simpleway-grass/day/servo/1/HERE/tracker=os.abort",
    ],
)
def test_other_links_are_refused_in_one_short_line(text):
    build = LINK.text.rpartition("/")[2]
    with pytest.raises(ConfigError) as refused:
        read_link(text.replace("HERE", build), OFFER)
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 600


def test_a_world_that_no_link_can_hold_says_what_it_cannot():
    other = WorldChoice(updated(GRASS.config, {"camera": {"model": "small-drone"}}), GRASS.vehicles)
    with pytest.raises(ConfigError, match="cannot hold the settings camera of this world"):
        link_of(other, "servo", 1, OFFER)
    with pytest.raises(ConfigError, match="not with this policy"):
        link_of(GRASS, "boxes", 1, OFFER)


def test_a_policy_of_ones_own_is_known_by_its_content(tmp_path, monkeypatch):
    from eyas.benchmark.policies.shipped import file_of

    monkeypatch.chdir(tmp_path)
    content = file_of("fast").read_bytes()
    (tmp_path / "mine.onnx").write_bytes(content)
    film = link_of(GRASS, "mine.onnx", 1, Offer.of(EyasConfig()))
    assert "mine" not in film.text
    (tmp_path / "mine.onnx").rename("yours.onnx")
    assert read_link(film.text, Offer.of(EyasConfig())).policy == "yours.onnx"
    (tmp_path / "yours.onnx").write_bytes(content + b"\0")
    with pytest.raises(ConfigError, match=r"policy: .* is not here, or its files differ"):
        read_link(film.text, Offer.of(EyasConfig()))


@pytest.mark.slow
def test_the_replayed_pictures_have_the_same_bytes(tmp_path, eyas_command):
    session = Session(GRASS.config, partial(Offer.of, GRASS.config), tmp_path)
    now = 0.0

    def fly(seconds):
        nonlocal now
        for _ in range(round(seconds / 0.03)):
            now += 0.03
            session.advance(now)

    session.clock.skip(now)
    carry_out(session, said.KeysMessage(held={"forward": 1.0, "climb": 0.5}, sequence=1, time=1.0))
    session.hold({"forward": 1.0}, (1, 0.0), 1e9)
    fly(3.0)  # whatever was flown before
    carry_out(session, said.DoMessage(what="next_target"))
    told = carry_out(session, said.FilmMessage(link=LINK.text))
    assert told["film"]["link"] == LINK.text
    pictures = []
    while session.film.pictures < 50:
        before = session.film.pictures
        fly(0.03)
        assert session.film.pictures - before <= 1
        if session.film.pictures > before:
            pictures.append(session.film.picture)
    state = session.frame(now)
    assert np.array_equal(state.rgb, pictures[-1])
    digest = session.film.digest
    alone = flown(LINK, 2.0, tmp_path / "recorded")
    assert (alone.pictures, alone.digest) == (50, digest)
    done = eyas_command("replay", LINK.text, "--seconds", "2")
    assert done.stdout.startswith(f"50 pictures of 640 x 480, digest {digest}\nto record it: ")
    assert len(list((tmp_path / "recorded").rglob("*.jpeg"))) == 50
    other = LINK.text.replace("/4711/", "/4712/")
    assert flown(read_link(other, OFFER), 0.4, None).digest != flown(LINK, 0.4, None).digest


@pytest.mark.slow
def test_a_recording_of_the_film_has_its_pictures(tmp_path):
    png = updated(GRASS.config, {"video": {"writers": ["png"]}})
    flight = WorldChoice(png, GRASS.vehicles).build()
    film, controller = begun(LINK, flight)
    recording, pictures = DemoRecording(flight, tmp_path / "run", SIZE), []
    while film.pictures < 5:
        command, steps = controller.decide()
        while steps:
            some = min(steps, film.steps_left)
            flight.fly(command, some, {})
            recording.count(command, some)
            film.count(some)
            if film.steps_left == STEPS:
                pictures.append(film.picture)
            steps -= some
    recording.end()
    files = sorted((tmp_path / "run").rglob("*.png"))
    assert len(files) >= 5
    for path, picture in zip(files, pictures, strict=False):
        with Image.open(path) as image:
            assert np.array_equal(np.asarray(image.convert("RGB")), picture)


@pytest.mark.slow
def test_a_film_in_another_world_begins_when_that_is_built_and_a_key_ends_it(tmp_path):
    config = updated(GRASS.config, {"seed": 4})
    session = Session(config, partial(Offer.of, config), tmp_path)
    assert "busy" in carry_out(session, said.FilmMessage(policy="follow"))
    session.builder._built.exception(120)
    told = enter_new_world(session)
    assert told["film"]["policy"] == "follow"
    assert told["world"]["map"] == "simpleway-grass"
    session.film.pictures = 1500
    assert end_film(session)["film"]["digest"]
    assert session.controller is None
    carry_out(session, said.FilmMessage(policy="follow"))
    carry_out(session, said.KeysMessage(held={"forward": 1.0}, sequence=1, time=1.0))
    assert session.film is None
    with pytest.raises(EyasError, match="known"):
        carry_out(session, said.FilmMessage(policy="os:abort"))
    with pytest.raises(ConfigError, match="missing"):
        carry_out(session, said.FilmMessage())
