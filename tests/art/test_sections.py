"""The boxes of trucks and their trailers: as large as what is drawn of them."""

import numpy as np
import pytest

from art.parts import levels_of
from art.vehicles.models import VEHICLES
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of, sections_of
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs, part_library

ARTICULATED = [model for model in range(len(MODELS)) if sections_of(model)]
SLACK = 0.1  # [m]


def box_of(block):
    """Lowest and highest corner of a box in the frame of the straight vehicle [m]."""
    half = 0.5 * np.array(block.size)
    middle = np.array([block.ahead, 0.0, half[2]])
    return middle - half, middle + half


def test_vehicles_with_trailers_have_sections_and_no_others():
    assert ARTICULATED == list(models_of(kind_index("trailer")))
    for model in ARTICULATED:
        assert [(s.name, s.towed) for s in sections_of(model)] == [("truck", 0), ("trailer", 1)]


@pytest.mark.parametrize("model", ARTICULATED)
def test_a_section_is_as_large_as_its_mesh(model):
    one = next(each for each in VEHICLES if each.name == MODELS[model].name)
    add = one.trailer.shape
    meshes = one.body(one), levels_of(lambda shell, detail: add(shell, one, detail))
    for section, levels in zip(sections_of(model), meshes, strict=True):
        low, high = box_of(section)
        points = levels[0].positions
        assert np.abs(points.max(axis=0) - high).max() < SLACK
        assert np.abs(points.min(axis=0) - low)[:2].max() < SLACK
        # Each point is in one of its blocks, and none of these is much larger than what it holds.
        inside = []
        for low, high in map(box_of, section.blocks):
            held = ((points > low - SLACK) & (points < high + SLACK)).all(axis=1)
            assert np.abs(points[held].max(axis=0) - high).max() < 0.25
            inside.append(held)
        assert np.any(inside, axis=0).all()
    whole = np.array([box_of(section) for section in sections_of(model)])
    assert np.ptp(whole, axis=(0, 1)) == pytest.approx(one.size)


def test_nothing_of_a_folded_truck_is_farther_away_than_its_rig_says():
    """Else what is at the edge of a picture would be left out."""
    kind = kind_index("trailer")
    rigs, hitch = Rigs(np.array([kind], np.int32)), np.linspace(-1.5, 1.5, 61)
    actors = ActorState.create(len(hitch), 1)
    actors.hitch[:, 0], actors.present[:] = hitch, True
    levels = part_library((KINDS[kind],)).parts
    far = np.array([np.linalg.norm(part[0].positions, axis=1).max() for part in levels])
    (reach,) = rigs.reach(far)
    for model in models_of(kind):
        drawn = rigs.draw_list(len(hitch))
        looks = np.full((len(hitch), 1), model, np.int32), np.ones((len(hitch), 1, 3), np.float32)
        rigs.pose(actors, Looks(*looks), drawn)
        for part, pose in zip(drawn.part.ravel(), drawn.pose.reshape(-1, 3, 4), strict=True):
            points = levels[part][0].positions @ pose[:, :3].T + pose[:, 3]
            assert np.linalg.norm(points, axis=1).max() < reach
