"""The contract of people and robots, over all of them."""

import functools

import numpy as np
import pytest

from art.jointed.cycle import frames_of
from art.jointed.people.people import PEDESTRIANS, PEOPLE
from art.jointed.people.person import Posture
from art.jointed.people.wardrobe import dress_of
from art.jointed.robots import ROBOTS
from art.parts import levels_of
from eyas.engine.state.mesh import Surface
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.catalogue import MODELS, extent_of, kind_index, models_of
from eyas.engine.targets.config import TargetName
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs

FIGURES = {model.name: model.figure for model in (*PEDESTRIANS, *ROBOTS)}
LOOKS = {person.name: person for person in (*PEOPLE[:8], *PEOPLE[8::8])}
"""People who wear each part, in each posture, at least once."""
NAMES = sorted(name for name in FIGURES if name in LOOKS or not name.startswith("Pedestrian"))
WALKERS = [name for name in NAMES if FIGURES[name].legs]
SLIDES = 0.01
"""How far a foot may move between its first and its last touch, as a share of the stride."""


def index_of(name):
    return next(m for m, model in enumerate(MODELS) if model.name == name)


@functools.cache
def drawn(name, level, *, antennas=False):
    """Points of the standing model at a level of detail, in the model frame."""
    figure = FIGURES[name]
    still = frames_of(figure, np.zeros(1), moving=False)[0]
    points = []
    for frame, (joint, shape) in zip(still, parts_of(figure), strict=True):
        if antennas or joint != "antenna":
            mesh = levels_of(shape)[level]
            points.append(mesh.positions @ frame[:, :3].T + frame[:, 3])
    return np.concatenate(points)


def parts_of(figure):
    for joint in figure.joints:
        if joint.shape is not None:
            yield joint.name, joint.shape
    for leg in figure.legs:
        shapes = (*([leg.coxa[1]] if leg.coxa else []), *leg.shapes)
        yield from (("leg", shape) for shape in shapes if shape is not None)


def posed(name, **state):
    """Parts and poses of models of one kind, one for each number in the arrays of a state."""
    model = index_of(name)
    kind = kind_index(MODELS[model].kind)
    count = max(len(np.atleast_1d(values)) for values in state.values())
    rigs, actors = Rigs(np.array([kind], np.int32)), ActorState.create(count, 1)
    actors.present[:] = True
    for key, values in state.items():
        array = getattr(actors, key)
        array[:] = (
            np.reshape(values, (-1, *[1] * (array.ndim - 1))) if key != "position" else values
        )
    looks = Looks(np.full((count, 1), model, np.int32), np.ones((count, 1, 3), np.float32))
    out = rigs.draw_list(count)
    rigs.pose(actors, looks, out)
    return out.part, out.pose


def test_every_target_of_the_original_is_a_kind_of_its_name():
    names = {name.value for name in TargetName} - {"SUMO_VEHICLE", "Quadrotor"}
    assert {model.kind for model in (*PEDESTRIANS, *ROBOTS)} == names
    for name in names:
        first = MODELS[models_of(kind_index(name))[0]]
        assert first.name == first.typename == first.kind == name


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_it_has_its_size_and_stands_on_the_ground(name):
    for level in range(3):
        points = drawn(name, level)
        size = np.ptp(points, axis=0)
        assert size == pytest.approx(MODELS[index_of(name)].size, rel=0.1), level
        assert abs(points[:, 2].min()) < 0.003 + 0.02 * size[2]
        middle = (points.min(axis=0) + points.max(axis=0))[:2] / 2
        assert np.abs(middle).max() < 0.1 * max(size)


@pytest.mark.parametrize("name", NAMES)
def test_levels_are_closed_and_become_coarser(name):
    totals = np.zeros(3)
    for _, shape in parts_of(FIGURES[name]):
        for level, mesh in enumerate(levels_of(shape)):
            totals[level] += len(mesh.triangles)
            assert np.isfinite(mesh.positions).all()
            assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-4)
    assert totals[0] > totals[1] > totals[2]
    assert totals[2] <= 250 + 30 * len(list(parts_of(FIGURES[name])))


@pytest.mark.parametrize("name", NAMES)
def test_it_stays_on_the_ground_while_it_moves(name):
    cycle = np.arange(48) / 48
    frames = frames_of(FIGURES[name], cycle, moving=True)
    lowest = np.full(len(cycle), np.inf)
    for place, (_, shape) in enumerate(parts_of(FIGURES[name])):
        mesh = levels_of(shape)[0]
        height = mesh.positions @ frames[:, place, 2, :3].T + frames[:, place, 2, 3]
        lowest = np.minimum(lowest, height.min(axis=0))
    tall = MODELS[index_of(name)].size[2]
    assert lowest.min() > -0.04 * tall
    if FIGURES[name].gait.duty >= 0.5:  # a galloping dog flies
        assert lowest.max() < 0.03 * tall


def phases(name):
    """When each leg touches the ground, as a share of the cycle, in the order of the legs."""
    return [round(-leg.phase % 1.0, 3) for leg in FIGURES[name].legs]


@pytest.mark.parametrize("name", WALKERS)
def test_feet_are_lifted_when_they_swing(name):
    figure, slot = FIGURES[name], 0
    slot = len([joint for joint in figure.joints if joint.shape is not None])
    parts = list(parts_of(figure))
    for leg in figure.legs:
        slot += 2 + (leg.coxa is not None) + (leg.shapes[2] is not None)
        flying = (1.0 + figure.gait.duty) / 2.0 - leg.phase
        frame = frames_of(figure, np.array([flying % 1.0]), moving=True)[0, slot - 1]
        height = levels_of(parts[slot - 1][1])[0].positions @ frame[2, :3] + frame[2, 3]
        assert figure.gait.lift > 0.0
        assert height.min() > 0.5 * figure.scale * figure.gait.lift


def test_legs_step_in_the_order_of_their_kind():
    """Biped; tripods of a hexapod, opposite; trot, by diagonals; walk; gallop, in pairs."""
    for name in WALKERS:
        figure, when = FIGURES[name], phases(name)
        left = [leg.hip[1] > 0.0 for leg in figure.legs]
        if len(when) == 2:
            assert abs(when[0] - when[1]) == 0.5
        elif len(when) == 6:
            front = sorted(range(6), key=lambda k: figure.legs[k].foot[0])
            for side in (True, False):
                own = [when[k] for k in front if left[k] == side]
                assert own[0] == own[2] != own[1]
            assert sorted(when) == [0.0] * 3 + [0.5] * 3
        else:
            place = {(leg.foot[0] > 0.0, leg.hip[1] > 0.0): t
                     for leg, t in zip(figure.legs, when, strict=True)}  # fmt: skip
            gaps = np.array([place[True, True] - place[False, False],
                             place[True, False] - place[False, True],
                             place[True, True] - place[True, False]]) % 1.0  # fmt: skip
            if name == "BioloidDog":
                assert gaps.tolist() == [0.0, 0.0, 0.5]
            elif name == "GhostDog":  # each pair nearly together, apart from the other
                assert min(gaps[2], 1.0 - gaps[2]) < 0.15
                assert 0.3 < gaps[0] < 0.7
            else:  # one after the other
                assert len(set(when)) == 4


@pytest.mark.parametrize(
    "name", [name for name, person in LOOKS.items() if person.posture is Posture.FREE]
)
def test_arms_swing_against_their_legs_and_knees_bend_forward(name):
    figure, cycle = FIGURES[name], np.arange(64) / 64
    frames = frames_of(figure, cycle, moving=True)
    names = [joint.name for joint in figure.joints if joint.shape is not None]
    for k, side in enumerate(("left", "right")):
        leg = figure.legs[k]
        assert (leg.hip[1] > 0.0) == (side == "left")
        hand = frames[:, names.index(f"{side} forearm")]
        foot = frames[:, len(names) + 3 * k + 2, 0, 3]
        reach = hand[:, 0, 3] - 0.25 * hand[:, 0, 2]  # where the forearm ends
        assert np.corrcoef(reach, foot)[0, 1] < -0.8
        hip, knee = frames[:, len(names) + 3 * k, :, 3], frames[:, len(names) + 3 * k + 1, :, 3]
        share = (hip[:, 2] - knee[:, 2]) / (hip[:, 2] - frames[:, len(names) + 3 * k + 2, 2, 3])
        straight = hip[:, 0] + share * (foot - hip[:, 0])
        assert (knee[:, 0] >= straight - 1e-3).all()


@pytest.mark.parametrize("person", [person for person in LOOKS.values() if person.garment.is_long])
def test_thighs_are_clothed_as_far_as_coats_and_dresses_reach(person):
    for level in range(3):
        mesh = levels_of(dress_of(person).thighs[0])[level]
        cloth = np.array([material.surface is Surface.PAINT for material in mesh.palette])
        covered = mesh.positions[mesh.triangles[cloth[mesh.materials]].ravel()]
        assert covered[:, 2].min() < -0.25


@pytest.mark.parametrize("name", WALKERS)
def test_feet_that_stand_do_not_slide(name):
    """Through the table that the actors are posed from, so that its intervals count, too."""
    figure = FIGURES[name]
    gait, stride = figure.gait, figure.scale * figure.gait.stride
    steps = np.linspace(0.0, 1.0, 401)
    _, pose = posed(name, travelled=steps * stride, speed=np.full(401, 9.0))
    slot = len([joint for joint in figure.joints if joint.shape is not None])
    for leg in figure.legs:
        slot += 2 + (leg.coxa is not None) + (leg.shapes[2] is not None)
        last = pose[:, slot - 1].astype(np.float64)
        if leg.shapes[2] is None:
            points = [last[:, :, 3] - leg.bones[1] * last[:, :, 2]]
        else:
            soles = [(-leg.sole[0], 0.0, -leg.foot[2]), (leg.sole[1], 0.0, -leg.foot[2])]
            points = [last[:, :, :3] @ np.array(sole) + last[:, :, 3] for sole in soles]
        begun = np.floor(steps + leg.phase)
        part = steps + leg.phase - begun
        # The heel stands at first, the toes at last.
        heel = (part > 0.005) & (part < 0.55 * gait.duty)
        toes = (part > 0.2 * gait.duty) & (part < 0.98 * gait.duty)
        stands = [heel | toes] if len(points) == 1 else [heel, toes]
        for point, standing in zip(points, stands, strict=True):
            in_world = point[:, 0] + (steps - begun) * stride
            assert np.ptp(in_world[standing]) < SLIDES * stride


@pytest.mark.parametrize("name", WALKERS)
def test_legs_reach_their_feet(name):
    figure = FIGURES[name]
    frames = frames_of(figure, np.arange(64) / 64, moving=True)
    slot = len([joint for joint in figure.joints if joint.shape is not None])
    for leg in figure.legs:
        slot += leg.coxa is not None
        hip, knee = frames[:, slot, :, 3], frames[:, slot + 1, :, 3]
        assert np.linalg.norm(knee - hip, axis=1) == pytest.approx(
            figure.scale * leg.bones[0], abs=1e-6
        )
        slot += 2 + (leg.shapes[2] is not None)


@pytest.mark.parametrize("name", NAMES)
def test_the_same_state_gives_the_same_pose_however_many_actors_there_are(name):
    travelled = np.linspace(0.0, 3000.0, 5000)  # enough for two threads
    _, many = posed(name, travelled=travelled, speed=np.full(5000, 1.0))
    for place in (0, 1234, 4999):
        _, one = posed(name, travelled=travelled[place], speed=[1.0])
        assert np.array_equal(one[0], many[place])


@pytest.mark.parametrize("name", NAMES)
def test_who_stands_is_at_rest_wherever_the_path_ended(name):
    spinning = FIGURES[name].wheel_radius > 0.0
    _, pose = posed(name, travelled=[0.0, 0.37, 12.3], speed=np.zeros(3))
    origins = pose[..., 3] if spinning else pose.reshape(3, -1)
    assert origins[1] == pytest.approx(origins[0], abs=1e-6)
    assert origins[2] == pytest.approx(origins[0], abs=1e-6)


def test_a_pedestrian_stays_upright_on_a_slope_with_the_feet_on_it():
    slope = 0.15
    _, pose = posed("Pedestrian", slope=[slope], speed=[0.0])
    assert pose[0, 0, :, 2] / FIGURES["Pedestrian"].scale == pytest.approx(
        [0.0, 0.0, 1.0], abs=0.01
    )
    feet = pose[0, [10, 13], :, 3]
    ankle = FIGURES["Pedestrian"].scale * FIGURES["Pedestrian"].legs[0].foot[2]
    assert feet[:, 2] == pytest.approx(feet[:, 0] * np.tan(slope) + ankle, abs=1e-5)


def test_a_robot_tilts_with_its_ground():
    _, pose = posed("Create", slope=[0.2], yaw=[0.7])
    ahead = np.cos(0.2) * np.array([np.cos(0.7), np.sin(0.7), np.tan(0.2)])
    assert pose[0, 0, :, 0] == pytest.approx(ahead, abs=1e-6)
    assert np.linalg.det(pose[0, 0, :, :3]) == pytest.approx(1.0, abs=1e-5)


def test_the_ball_of_bb8_rolls_and_its_head_stays_up():
    radius = FIGURES["BB-8"].wheel_radius
    _, pose = posed("BB-8", travelled=[0.0, 0.5 * np.pi * radius, np.pi * radius], speed=np.ones(3))
    ball, head = pose[:, 0], pose[:, 1]
    # After a quarter of a turn, what was on top is ahead; after half, it is below.
    assert ball[:, :, 2] == pytest.approx(np.array([[0, 0, 1], [1, 0, 0], [0, 0, -1]]), abs=1e-5)
    assert (head[:, 2, 2] > 0.95).all()
    assert (head[:, 2, 3] > 2 * radius).all()


def test_front_wheels_of_a_rover_steer_into_the_curve_and_rear_wheels_against_it():
    _, pose = posed("Sojourner", yaw_rate=[0.1], speed=[0.1])
    joints = [joint for joint in FIGURES["Sojourner"].joints if joint.steers]
    for joint in joints:
        slot = [j.name for j in FIGURES["Sojourner"].joints].index(joint.name)
        across = pose[0, slot, :, 1]
        assert np.sign(-across[0]) == np.sign(joint.steers)
        assert np.arctan(-across[0] / across[1]) == pytest.approx(np.arctan(joint.steers), abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("slope", [0.0, 0.2])
@pytest.mark.parametrize("name", NAMES)
def test_the_box_of_a_moment_holds_it_and_is_as_small_as_may_be(name, slope):
    rng = np.random.default_rng(2)
    travelled, speed = rng.uniform(0.0, 50.0, 12), rng.choice([0.0, 0.03, 0.6, 3.0], 12)
    yaw_rate = rng.uniform(-0.5, 0.5, 12)
    slopes = np.full(12, slope)
    part, pose = posed(name, travelled=travelled, speed=speed, slope=slopes, yaw_rate=yaw_rate)
    meshes = [levels_of(shape)[0].positions for _, shape in parts_of(FIGURES[name])]
    upright = FIGURES[name].upright
    across = np.array(
        [[np.cos(slope), 0, -np.sin(slope)], [0, 1, 0], [np.sin(slope), 0, np.cos(slope)]]
    )
    if upright:
        across = np.array([[1.0, 0, 0], [0, 1, 0], [np.tan(slope), 0, 1]])
    spare = []
    for k in range(12):
        points = np.concatenate(
            [
                meshes[slot] @ pose[k, slot, :, :3].T + pose[k, slot, :, 3]
                for slot in range(len(meshes))
                if part[k, slot] >= 0
            ]
        )
        points = points @ np.linalg.inv(across).T  # in its own frame
        low, high = extent_of(index_of(name), travelled[k], speed[k], slope)
        assert (points >= low - 1e-3).all()
        assert (points <= high + 1e-3).all()
        spare.append(np.max([points.min(axis=0) - low, high - points.max(axis=0)]))
    rolls = any(joint.spins for joint in FIGURES[name].joints)
    assert max(spare) < (0.3 if rolls else 0.03) * max(MODELS[index_of(name)].size)


def test_vehicles_fill_the_box_of_their_size():
    assert extent_of(0, 3.0, 10.0, 0.0) is None
