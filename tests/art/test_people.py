"""The people of the catalogue: a hundred looks that are drawn as they are described."""

import functools

import numpy as np
import pytest

from art.jointed.cycle import frames_of, shapes_of
from art.jointed.extent import extents_of
from art.jointed.people.people import PEDESTRIANS, PEOPLE
from art.jointed.people.person import Build, Carried, Garment, Lower
from art.jointed.people.wardrobe import colours_of, dress_of
from art.parts import DETAILS, levels_of
from eyas.cli.targets.show import StageCamera, TargetPose, TargetStage
from eyas.engine.mesh.shell import Shell
from eyas.engine.state.mesh import Surface
from eyas.engine.targets.catalogue import KINDS, kind_index, models_of
from eyas.engine.targets.colour_names import COLOUR_NAMES, colour_distances, colour_name

COLOURS = KINDS[kind_index("Pedestrian")].colours
CUTS = {(person.garment, person.cut): number for number, person in enumerate(PEOPLE)}
MOST = (1750, 1050, 450)
"""Triangles of a person at each level of detail, with a bag; a pram has more."""


@functools.cache
def meshes(shape):
    return levels_of(shape)


@functools.cache
def counts(shape):
    """Triangles at each level; meshes, with normals, take ten times as long."""
    shells = [Shell() for _ in DETAILS]
    for shell, detail in zip(shells, DETAILS, strict=True):
        shape(shell, detail)
    return [len(shell.corners()) // 3 for shell in shells]


def test_a_hundred_looks_differ_before_they_get_a_colour():
    looks = {
        (model.size, tuple(shapes_of(model.figure)), model.part_colours) for model in PEDESTRIANS
    }
    assert len(looks) == len(PEDESTRIANS) >= 100
    kinds = [
        {getattr(person, field) for person in PEOPLE} for field in ("build", "garment", "lower")
    ]
    assert kinds == [set(Build), set(Garment), set(Lower)]
    assert {person.carried for person in PEOPLE} == set(Carried)
    assert len({model.words[-1] for model in PEDESTRIANS}) > 90


def test_the_first_is_the_originals():
    first = PEDESTRIANS[0]
    assert (first.size, first.speed) == ((0.4, 0.6, 1.8), 2.0)
    assert first.rise == pytest.approx(1.27)
    assert colour_name(COLOURS[0]) == "green"


def test_each_look_has_few_triangles_at_each_level():
    for person, model in zip(PEOPLE[::2], PEDESTRIANS[::2], strict=True):
        totals = np.sum([counts(shape) for shape in shapes_of(model.figure)], axis=0)
        most = [1.4 * n if person.carried is Carried.PRAM else n for n in MOST]
        assert (totals <= most).all(), person
        assert totals[0] > 1.5 * totals[1] > 2.0 * totals[2]


def test_bodies_are_closed_and_their_faces_point_outwards():
    shapes = dict.fromkeys(shape for model in PEDESTRIANS for shape in shapes_of(model.figure))
    for shape in list(shapes)[::4]:
        for mesh in meshes(shape):
            corners = mesh.positions[mesh.triangles].astype(np.float64)
            middle = corners.mean(axis=(0, 1))
            faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            # By the theorem of Gauss, the volume; what is open or turned inside out has less.
            assert np.einsum("ij,ij->", faces, corners[:, 0] - middle) > 0.0
            along = np.einsum("ij,ij->i", faces, mesh.normals[mesh.triangles].sum(axis=1))
            assert (along > 0.0).all()


@pytest.mark.parametrize("number", [0, 3, 10, 22, 39, 60, 90])
def test_the_box_of_a_moment_holds_every_level(number):
    figure = PEDESTRIANS[number].figure
    extents, shapes = extents_of(figure), shapes_of(figure)
    for cycles in (0.0, 0.13, 0.61):
        frames = frames_of(figure, np.array([round(32 * cycles) / 32]), moving=True)[0]
        low, high = extents.at(round(32 * cycles) / 32 * extents.stride, speed=2.0)
        for level in range(3):
            for shape, frame in zip(shapes, frames, strict=True):
                points = meshes(shape)[level].positions @ frame[:, :3].T + frame[:, 3]
                assert (points >= low - 1e-4).all()
                assert (points <= high + 1e-4).all()


def test_parts_that_are_the_garments_have_no_colour_of_their_own():
    for person in PEOPLE:
        dress, own = dress_of(person), colours_of(person)
        drawn = [dress.chest, dress.hips, dress.head, dress.hair]
        assert own[0] is None
        assert len(own) == len([part for part in drawn if part is not None]) + 4 + 6 + (
            dress.carried is not None
        )
        palette = meshes(dress.chest)[0].palette
        assert any(material.surface is Surface.PAINT for material in palette)


@pytest.fixture(scope="module")
def stage():
    return TargetStage(["Pedestrian"])


def linear(picture):
    return np.power(np.asarray(picture, np.float64), 2.2)


def worn(stage, number, colour):
    """The mean colour, linear, of the pixels that show the garment."""
    model = models_of(kind_index("Pedestrian"))[number]
    pose = TargetPose(travelled=0.4, speed=1.3)
    camera = StageCamera(bearing=2.0, elevation=0.5, distance=5.0, field_of_view=0.5)
    own, red, green = (
        stage.draw(model, paint, [(pose, camera)], (120, 120))[0]
        for paint in (colour, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    )
    changed = np.abs(red.astype(int) - green).max(axis=2) > 24
    assert changed.sum() > 150
    return linear(own[changed] / 255.0).mean(axis=0)


@pytest.mark.slow
def test_colours_that_words_name_are_those_of_the_pixels(stage):
    """But for one factor of brightness for all: the light of the day."""
    dull = [colour for colour in COLOURS if min(colour) < 0.6]  # the tone curve dims white
    cases = [
        (number, dull[(5 * k + shift) % len(dull)])
        for k, number in enumerate(CUTS.values())
        for shift in (0, 7)
    ]
    shown = np.array([worn(stage, number, colour) for number, colour in cases])
    meant = linear([colour for _, colour in cases])
    light = np.median(shown.sum(axis=1) / meant.sum(axis=1))
    seen = np.power(np.clip(shown / light, 0.0, 1.0), 1 / 2.2)
    nearest = np.argsort(colour_distances(seen), axis=1)
    names = list(COLOUR_NAMES)
    said = [names.index(colour_name(colour)) for _, colour in cases]
    first = np.mean([row[0] == own for row, own in zip(nearest, said, strict=True)])
    assert first > 0.7
    for row, own in zip(nearest, said, strict=True):
        assert own in row[:3]
