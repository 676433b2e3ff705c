"""The server in a process of its own, against the independent client of `client.py`."""

import io
import json
import resource
import signal
import sys
import threading
import time
from contextlib import suppress

import numpy as np
import pytest
from PIL import Image

from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.settings.file import load_settings
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.worlds import together as in_one_world
from eyas.engine.state.draw import Picture

from .conftest import PATIENCE

AHEAD, TURN = (15.0, 0.0, 0.0, 0.0), (10.0, 0.0, 0.0, 0.3)


def done(process):
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, err
    return json.loads(out.splitlines()[-1])


def test_300_steps_of_two_agents_are_those_of_a_simulation_to_the_byte(serve, together):
    overrides = ("camera.width=64", "camera.height=48", "traffic.demand=keep_alive", "seed=5")
    # Nobody walks and no signal works where the original is served.
    overrides = (*overrides, "extras=[]", "traffic.signals=amber", "traffic.lamps=dark")
    sim = build_simulation(load_settings(None, overrides), in_one_world(2))
    picture, both = Picture.create(2, 48, 64), np.arange(2, dtype=np.int32)
    server = serve("seed=5")
    server.announce(2)
    server.until("serving DRONE0 to DRONE1")
    agents = [server.client(number) for number in range(2)]
    resets, ends = np.ones(2, np.bool_), 0
    for step in range(300):
        calls = [
            agent.reset if reset else lambda agent=agent, go=go: agent.step(go)
            for agent, reset, go in zip(agents, resets, (AHEAD, TURN), strict=True)
        ]
        read = together(*calls)
        if not resets.all():
            sim.advance(np.where(resets[:, None], 0.0, [AHEAD, TURN]), 4)
        if resets.any():
            sim.reset(resets)
        basic, reward = sim.packets()
        sim.draw(both, picture)
        for n, (state, (*numbers, kind), jpeg) in enumerate(read):
            assert state == basic[n].tolist(), step
            assert numbers == reward[n].tolist(), step
            assert kind.isidentifier()
            assert jpeg == jpeg_bytes(picture.rgb[n]), step
        resets = basic[:, 21] == 1.0
        ends += resets.sum()
    assert ends >= 2  # some episodes have ended, and others were begun


@pytest.fixture
def pair(serve):
    """A server with the clients of both of its agents, after their first resets."""
    server = serve("wire.patience=1.5", "done.no_reward_steps=100000")
    server.announce(2)
    server.until("serving DRONE0 to DRONE1")
    return server, server.client(0), server.client(1)


@pytest.mark.slow
def test_a_client_killed_at_any_moment_is_reported_and_a_new_one_takes_its_place(pair):
    server, mine, _ = pair
    rounds = []

    def fly():
        mine.reset()
        with suppress(TimeoutError):
            while True:
                rounds.append(mine.step(AHEAD)[0][0])

    flying = threading.Thread(target=fly)
    flying.start()
    for moment in (0.5, 0.53, 0.57, 0.6):
        server.lines.clear()
        other = server.play(1, 2, 10**6)
        assert other.stdout.readline() == "begun\n"
        time.sleep(moment)
        other.kill()
        server.until("DRONE1: nothing for 1.5 s")
        flown = len(rounds)
        time.sleep(0.2)
        assert len(rounds) - flown <= 1  # lock-step
    successor = server.client(1)
    assert successor.reset()[0][0] == 0.0
    successor.step(AHEAD)
    server.until("DRONE1: goes on")
    mine.patience = 0.0
    flying.join()
    assert rounds == sorted(rounds)  # one episode all the time
    assert server.end() == 130


@pytest.mark.slow
def test_the_clients_of_a_second_training_follow_those_of_the_first(serve):
    server = serve()
    for _ in range(2):
        server.until("waiting for clients")
        players = [server.play(agent, 2, 20) for agent in range(2)]
        assert [done(player)["seconds"] > 0 for player in players] == [True, True]
    assert server.left() == ["start.txt"]
    killed = [server.play(agent, 2, 10**6) for agent in range(2)]
    for player in killed:
        assert player.stdout.readline() == "begun\n"
        player.kill()
        player.wait()
    players = [server.play(agent, 3, 20) for agent in range(3)]  # of another number of agents
    for player in players:
        done(player)
    assert any("serving DRONE0 to DRONE2" in line for line in server.lines)


def test_garbage_is_told_and_harms_nobody(pair, together):
    server, one, two = pair
    together(one.reset, two.reset)
    rng = np.random.default_rng(3)
    for agents in (b"", b"\xff" * 300, b"-5\n", b"two\n"):
        server.announce(message=agents)
    for _ in range(30):
        line = rng.integers(0, 256, rng.integers(1, 200), np.uint8).tobytes() + b"\n"

        def garbage(line=line):
            two.send(line)
            two.until(lambda: not two.action.exists())
            return two.answer()

        (state, _, _), (other, _, _) = together(lambda: one.step(AHEAD), garbage)
        assert state[0] == other[0]
        assert np.isfinite(state).all()
    assert server.until("DRONE1: action line b").endswith("; it hovers")
    assert server.until("not a number of agents")
    assert server.end() == 130


def test_files_in_the_wrong_order_stop_nobody(pair, together):
    server, one, two = pair
    together(one.reset, two.reset)

    def impatient():
        """Send the next action when the last answer has not been taken, twice."""
        for reset in (0, 1):
            two.send(f"0,0,0,0,{reset}\n")
            two.until(lambda: not two.action.exists())
            two.until(two.state.exists)
        return two.answer()

    def patient():
        one.step(AHEAD)
        return one.step(AHEAD)

    (state, _, _), (other, _, _) = together(patient, impatient)
    assert (state[0], other[0]) == (8.0, 0.0)
    assert "a new action while DRONE1_Ctrl2Global.txt was not taken" in " ".join(server.lines)
    (state, _, _), (other, _, jpeg) = together(one.reset, lambda: two.step(AHEAD))
    assert (state[0], other[0]) == (0.0, 4.0)
    Image.open(io.BytesIO(jpeg)).load()


@pytest.mark.skipif(sys.platform != "linux", reason="needs `prlimit`")
def test_a_full_disk_is_told_and_waited_for(pair, together):
    server, one, two = pair
    together(one.reset, two.reset)
    limits = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE)
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (100, limits[1]))
    one.patience = two.patience = 1.5
    failed = together(*(lambda c=client: fails(c) for client in (one, two)))
    assert failed == [True, True]
    assert "Ctrl2Global.txt: cannot write: File too large; trying again" in " ".join(server.lines)
    assert server.left() == ["start.txt"]  # no half of a file
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, limits)
    one.patience = two.patience = 60.0
    (state, _, _), _ = together(one.answer, two.answer)
    assert state[0] == 4.0
    server.until("written again")


def fails(client):
    try:
        client.step(AHEAD)
    except TimeoutError:
        return True
    return False


@pytest.mark.slow
def test_servers_side_by_side_keep_apart(serve, tmp_path):
    servers = [serve(root=tmp_path / name) for name in "ab"]
    for server in servers:
        server.until("waiting for clients")
    players = [server.play(0, 1, 20) for server in servers]
    for player in players:
        done(player)
    same_port = serve(root=tmp_path / "c")
    same_port.end()
    taken = serve(f"wire.port={servers[0].port}", root=tmp_path / "d")
    line = taken.until("error: wire.port: cannot listen on UDP port")
    assert "Address already in use" in line
    assert taken.ended() == 2
    shared = serve(root=tmp_path / "a")
    assert shared.until(f"process {servers[0].process.pid} is serving in it")
    assert shared.ended() == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("moment", "number"),
    [
        ("waiting for clients", signal.SIGINT),
        ("1 agent announced", signal.SIGINT),
        ("serving DRONE0 in", signal.SIGINT),
        ("begun", signal.SIGINT),
        ("begun", signal.SIGTERM),
    ],
)
def test_it_stops_cleanly_at_any_moment(serve, moment, number):
    server = serve()
    server.until("waiting for clients")
    player = server.play(0, 1, 10**6)
    if moment == "begun":
        assert player.stdout.readline() == "begun\n"
    else:
        server.until(moment)
    assert server.end(number) == 128 + number, server.lines
    assert "Traceback" not in " ".join(server.lines)
    assert server.lines[-1].endswith("; clients that still wait must be started again")
    assert not [name for name in server.left() if "AlgAction" not in name]


def test_its_switches_have_an_effect(serve):
    server = serve("wire.reward_packet=false", "Control_Frequence=250", "verbose=true")
    server.announce(1)
    agent = server.client(0, rewards=False)
    agent.reset()
    assert [agent.step(AHEAD)[0][0] for _ in range(3)] == [2.0, 4.0, 6.0]
    log = server.root / "Webots_Simulation/traffic_project/logs/Agent0.log"
    lines = [line.partition(" : ")[2] for line in log.read_text().splitlines()]
    assert lines[0] == "received b'0.0,0.0,0.0,0.0,1'"
    assert lines[-1].startswith("id: DRONE0 done: 0 reward: ")
    assert lines[-2] == "id: DRONE0 ACTIONS forward:15 leftRight:0 turn:0(deg/s)"
    assert " count: 6 " in lines[-1]


def test_the_radar_packet_comes_between_reward_and_picture(serve):
    server = serve("Lidar_Enable=true")
    server.announce(1)
    agent = server.client(0, radar=True)
    agent.reset()
    agent.step(AHEAD)
    points = [agent.cloud[point : point + 5] for point in range(0, 2000, 5)]
    assert all(z == 0 and layer == 0 and time > 0 for _, _, z, layer, time in points)
    agent.reset()
    assert not [name for name in server.left() if "PointCloud" in name]
