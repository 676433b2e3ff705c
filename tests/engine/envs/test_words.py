"""The target in words, among what is in view."""

import numpy as np
import pytest

from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import Picture
from eyas.engine.targets.words import phrases


@pytest.fixture(scope="module")
def simulation():
    made = build_simulation(SimConfig(extras=()), each_alone(1))
    made.reset(np.ones(1, np.bool_))
    return made


def own_phrases(simulation):
    target = simulation.snapshot.targets.actor[0]
    (model,), (colour,) = simulation.looks_around(0)
    return phrases(int(model[target]), colour[target])


def test_a_target_alone_in_view_is_called_by_its_class_and_colour(simulation):
    simulation.snapshot.cameras.field_of_view[0] = 0.01
    assert simulation.view.words(0, 0.75) == own_phrases(simulation)[0]


def test_where_all_look_alike_it_is_told_by_what_it_does_or_where_it_is(simulation):
    simulation.make_alike()
    simulation.snapshot.cameras.field_of_view[0] = 3.1
    target = simulation.snapshot.targets.actor[0]
    actors, _ = simulation.actors_around(0)
    away = actors.position[0] - simulation.snapshot.cameras.position[0]
    ahead = (away @ simulation.snapshot.cameras.rotation[0][:, 0] > 0) & actors.present[0]
    ahead[target] = False
    assert ahead.any()
    told = simulation.view.words(0, 1.0)
    assert told.startswith(f"{own_phrases(simulation)[0]}, ")
    assert "driving" in told or "turning" in told or "standing" in told or " of " in told


def test_a_rival_counts_if_a_sliver_of_it_is_in_the_picture(simulation):
    """Cameras look down beside vehicles that look alike, so that most stick into the picture."""
    simulation.make_alike()
    cameras, rng = simulation.snapshot.cameras, np.random.default_rng(0)
    cameras.rotation[0] = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    cameras.field_of_view[0] = 0.8
    target = int(simulation.snapshot.targets.actor[0])
    actors, _ = simulation.actors_around(0)
    picture = Picture.create(1, 48, 64, subject=True, actors=simulation.actors)
    slivers = 0
    for rival in np.flatnonzero(actors.present[0]).tolist():
        for _ in range(4):
            aside = rng.uniform(3.0, 6.0) * rng.choice([-1.0, 1.0], 2)
            cameras.position[0] = actors.position[0, rival] + [*aside, 9.0]
            simulation.draw(np.array([0], np.int32), picture)
            seen = picture.actor_pixels[0, :, 0] > 0
            seen[target] = False
            if seen.any():
                slivers += 1
                assert ", " in simulation.view.words(0, 48 / 64)
    assert slivers > 20
