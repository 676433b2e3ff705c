import io

import numpy as np
import pytest
from PIL import Image

from eyas.dat.wire.exchange import HOVER, RESET, Action
from eyas.dat.wire.tracker_group import TrackerGroup
from eyas.engine.core.errors import SpawnError
from eyas.engine.sensors.config import LidarConfig
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import ControlConfig, SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.task.config import DoneConfig
from eyas.engine.traffic.config import TrafficConfig

AHEAD = Action((20.0, 0.0, 0.0, 0.5), reset=False)

CONFIG = SimConfig(camera={"width": 64, "height": 48}, done=DoneConfig(no_reward_steps=10_000))


class Group(TrackerGroup):
    def play(self, actions):
        """Carry out one action of each, as the loop does."""
        orders = self.orders(actions)
        if orders.steps:
            self.sim.advance(*orders)
        return self.answers()


@pytest.fixture
def crews():
    made = []

    def make(count, config=CONFIG, steps=4):
        made.append(Group(build_simulation(config, together(count)), steps))
        return made[-1]

    yield make
    for group in made:
        group.close()


def numbers(answer):
    return [float(word) for word in answer.state.decode().split(",")]


def test_answers_are_those_of_a_simulation_of_the_same_seed(crews):
    group, sim = crews(3), build_simulation(CONFIG, together(3))
    picture = Picture.create(3, 48, 64)
    for actions in ([RESET] * 3, [AHEAD, HOVER, AHEAD], [AHEAD, RESET, HOVER], [RESET] * 3):
        answers = group.play(actions)
        resets = np.array([action.reset for action in actions])
        if not resets.all():
            sim.advance(np.array([action.command for action in actions]), 4)
        if resets.any():
            sim.reset(resets)
        basic, reward = sim.packets()
        sim.draw(np.arange(3, dtype=np.int32), picture)
        for n, answer in enumerate(answers):
            assert numbers(answer) == basic[n].tolist()
            *words, kind = answer.reward.decode().strip().split(",")
            assert [float(word) for word in words] == reward[n].tolist()
            assert kind.isidentifier()
            shown = np.asarray(Image.open(io.BytesIO(answer.picture.result()))).astype(int)
            assert np.abs(shown - picture.rgb[n]).max() <= 8


def test_a_reset_begins_an_episode_of_its_tracker_only_and_time_goes_on(crews):
    group = crews(2)
    group.play([RESET, RESET])
    for _ in range(5):
        group.play([AHEAD, AHEAD])
    ticks = group.sim.snapshot.episodes.tick
    begun = ticks[0]
    states = [numbers(answer) for answer in group.play([RESET, AHEAD])]
    assert [state[0] for state in states] == [0, 24]
    assert ticks.tolist() == [begun + 4] * 2
    assert len(set(group.sim.snapshot.targets.actor.tolist())) == 2
    assert numbers(group.play([HOVER, HOVER])[0])[0] == 4


def test_whoever_acts_before_its_first_reset_gets_an_episode_too(crews):
    states = [numbers(answer) for answer in crews(2).play([AHEAD, RESET])]
    assert [(state[0], state[21]) for state in states] == [(0, 0), (0, 0)]


def test_where_the_traffic_ends_all_begin_anew_and_those_who_flew_are_told(crews):
    group = crews(2)
    group.play([RESET, RESET])
    group.sim.snapshot.episodes.tick[:] += group.sim.steps_left - 6
    states = [numbers(answer) for answer in group.play([AHEAD, AHEAD])]
    assert [(state[0], state[21]) for state in states] == [(4, 0), (4, 0)]
    states = [numbers(answer) for answer in group.play([RESET, AHEAD])]
    assert [(state[0], state[21]) for state in states] == [(0, 0), (0, 1)]
    first = CONFIG.start.warm_up_steps
    assert group.sim.snapshot.episodes.tick.tolist() == [first, first]
    states = [numbers(answer) for answer in group.play([AHEAD, RESET])]
    assert [(state[0], state[21]) for state in states] == [(4, 0), (0, 0)]


def test_all_who_reset_near_the_end_of_the_traffic_get_whole_episodes(crews):
    group = crews(2)
    group.play([RESET, RESET])
    group.sim.snapshot.episodes.tick[:] += group.sim.steps_left - 100
    states = [numbers(answer) for answer in group.play([RESET, RESET])]
    assert [(state[0], state[21]) for state in states] == [(0, 0), (0, 0)]
    assert group.sim.steps_left > CONFIG.done.total_steps


def test_where_no_target_is_free_the_traffic_begins_anew(crews, monkeypatch, caplog):
    group, reset, refused = crews(2), Simulation.reset, []
    group.play([RESET, RESET])

    def once(sim, trackers=None):
        if not refused:
            refused.append(1)
            raise SpawnError("start: no target is free")
        reset(sim, trackers)

    monkeypatch.setattr(Simulation, "reset", once)
    states = [numbers(answer) for answer in group.play([RESET, AHEAD])]
    assert [(state[0], state[21]) for state in states] == [(0, 0), (0, 1)]
    assert "no target is free; so the traffic begins anew" in caplog.text


def test_more_trackers_than_targets_is_one_line(crews):
    config = CONFIG.model_copy(update={"traffic": TrafficConfig()})
    with pytest.raises(SpawnError, match="at least as many targets as trackers"):
        crews(41, config).play([RESET] * 41)


def test_an_answer_that_nobody_takes_does_not_disturb_the_next(crews):
    patient, hasty = crews(4), crews(4)
    shown = [answer.picture.result() for answer in patient.play([RESET] * 4)]
    dropped = hasty.play([RESET] * 4)
    hasty.play([AHEAD] * 4)  # at once, while the pictures are still drawn
    assert [answer.picture.result() for answer in dropped] == shown


@pytest.mark.parametrize("speed", [1e4, -1e4])
def test_the_fastest_commands_that_are_let_through_can_be_drawn(crews, speed):
    group = crews(1)
    group.play([RESET])
    for _ in range(50):
        (answer,) = group.play([Action((speed, speed, speed, speed), reset=False)])
    assert np.isfinite(numbers(answer)).all()
    assert answer.picture.result()


def test_the_radar_packet_is_that_of_the_lidar(crews):
    config = CONFIG.model_copy(update={"lidar": LidarConfig(enabled=True)})
    group = crews(2, config)
    for answer, row in zip(group.play([RESET] * 2), group.sim.view.lidar.packets(), strict=True):
        assert [float(word) for word in answer.radar.decode().split(",")] == row.tolist()
    assert [answer.radar for answer in crews(1).play([RESET])] == [None]


def test_what_is_sensed_is_late_and_what_is_judged_is_not(crews):
    late = {"control": ControlConfig(observation_latency_steps=8.0)}
    lidar = {"lidar": LidarConfig(enabled=True)}
    group = crews(2, CONFIG.model_copy(update={**late, **lidar}))
    now = crews(2, CONFIG.model_copy(update=lidar))
    history = []
    for actions in ([RESET] * 2, *[[AHEAD, HOVER]] * 5):
        ours, theirs = group.play(actions), now.play(actions)
        history.append(theirs)
        then = history[max(len(history) - 3, 0)]
        for n in range(2):
            basic, present, past = map(numbers, (ours[n], theirs[n], then[n]))
            assert basic[1:20] == past[1:20]
            assert [basic[0], *basic[20:]] == [present[0], *present[20:]]
            assert ours[n].reward == theirs[n].reward
            assert ours[n].radar == then[n].radar
            assert ours[n].picture.result() == then[n].picture.result()
    assert numbers(ours[0])[1:20] != numbers(theirs[0])[1:20]
