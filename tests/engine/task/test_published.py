"""The published rewards, against their formulas computed apart."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from eyas.engine.core.errors import ConfigError
from eyas.engine.task.config import RewardConfig
from eyas.engine.task.published import TERMS
from eyas.engine.task.quantities import QUANTITIES, Setting
from eyas.engine.task.terms import RewardTerms

FIELD = 0.7854


def rewarded(snapshot, *terms, early_steps=0):
    config = RewardConfig(weight=0.0, terms=dict.fromkeys(terms, 1.0))
    return RewardTerms(config, Setting(0.75, early_steps)).of(snapshot)


def placed(snapshot, place, first=(4.5, 0.0, -22.0), yaw=0.0):
    snapshot.episodes.relative_position[1] = place
    snapshot.episodes.first_position[1] = first
    snapshot.targets.yaw[1] = yaw
    snapshot.cameras.field_of_view[:] = FIELD
    return snapshot


places = st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(-30, 30))


@given(place=places, first=places, yaw=st.floats(-3.1, 3.1))
def test_e2e_is_its_formula(place, first, yaw):
    from eyas.engine.state.snapshot import Snapshot

    snapshot = placed(Snapshot.create(3), place, first, yaw)
    value = rewarded(snapshot, "e2e")[0][1]
    (x, y, _), d = place, first[0]
    expected = 1 - (math.sqrt((x - d) ** 2 + y**2) / 9 + 2 / FIELD * abs(yaw))
    assert value == pytest.approx(min(max(expected, -1.0), 1.0))


@given(place=places, first=places)
def test_d_vat_is_its_formula(place, first):
    assume(abs(place[0]) > 1e-6)  # nearer, the slope depends on the last bits
    from eyas.engine.state.snapshot import Snapshot

    snapshot = placed(Snapshot.create(3), place, first)
    value = rewarded(snapshot, "d_vat")[0][1]
    (x, y, _), d = place, first[0]
    slope = y / x if abs(x) > 1e-9 else math.inf if y else 0.0
    r_x, r_y = max(0, 1 - abs(x - d)), max(0, 1 - abs(2 / FIELD * math.atan(slope)))
    assert value**3 == pytest.approx(r_x * r_y, abs=1e-9)  # the root blows up rounding at 0


def test_the_vertical_term_falls_from_the_middle_of_the_picture_to_its_edge(snapshot):
    placed(snapshot, (4.5, 0.0, -22.0))
    half = math.atan(0.75 * math.tan(FIELD / 2))
    values = []
    for angle in np.linspace(0.0, half, 5):
        # Cameras look east; the target is above the axis by this angle.
        snapshot.targets.centre[1] = 10 * math.cos(angle), 0.0, 10 * math.sin(angle)
        values.append(rewarded(snapshot, "d_vat_3d")[0][1])
    assert values == pytest.approx([s ** (1 / 3) for s in (1, 0.75, 0.5, 0.25, 0)], abs=1e-5)


def test_a_crash_costs_ten_once_the_start_is_over(snapshot):
    placed(snapshot, (4.5, 0.0, -22.0))
    snapshot.episodes.crash[1] = True
    snapshot.episodes.step_count[:] = 107
    assert rewarded(snapshot, "d_vat", early_steps=108)[0][1] == 1.0
    snapshot.episodes.step_count[:] = 108
    assert rewarded(snapshot, "d_vat", early_steps=108)[0].tolist()[1] == -10.0


def test_costs_of_speed_and_effort(snapshot):
    snapshot.trackers.velocity[1] = 3.0, 0.0, 4.0
    snapshot.trackers.smoothed_acceleration[1] = 0.0, -1.0, 0.0
    _, terms = rewarded(snapshot, "speed", "effort")
    assert terms["speed"].tolist() == pytest.approx([0.0, 5.0 / 6.0, 0.0])
    assert terms["effort"].tolist() == pytest.approx([0.0, 0.5, 0.0])


def test_weights_make_one_reward_of_several_terms(snapshot):
    placed(snapshot, (4.5, 0.0, -22.0))
    snapshot.trackers.velocity[1] = 1.0, 0.0, 0.0
    snapshot.episodes.reward[:] = 0.25
    config = RewardConfig(weight=2.0, terms={"d_vat": 0.5, "speed": -0.1})
    total, terms = RewardTerms(config).of(snapshot)
    assert total[1] == pytest.approx(2 * 0.25 + 0.5 * 1.0 - 0.1 * 0.5)
    assert list(terms) == ["builtin", "d_vat", "speed"]


def test_every_quantity_is_there_for_each_tracker(snapshot):
    for quantity in QUANTITIES.values():
        assert len(quantity(snapshot, Setting())) == 3


def test_visible_is_what_the_picture_covers(snapshot):
    snapshot.cameras.field_of_view[:] = FIELD
    edge = math.tan(FIELD / 2)
    for left, up, seen in (
        (0.99, 0.0, True),
        (1.01, 0.0, False),
        (0.0, 0.74, True),
        (0.0, 0.76, False),
    ):
        snapshot.targets.centre[1] = 10.0, 10 * left * edge, 10 * up * edge
        assert QUANTITIES["visible"](snapshot, Setting(0.75))[1] == seen
    snapshot.targets.centre[1] = -10.0, 0.0, 0.0
    assert not QUANTITIES["visible"](snapshot, Setting(0.75))[1]


def test_unknown_names_say_what_is_near():
    with pytest.raises(ConfigError, match="did you mean 'd_vat'"):
        RewardTerms(RewardConfig(terms={"dvat": 1.0}))
    assert len(TERMS) == 5
