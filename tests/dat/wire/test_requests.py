"""Agents that cannot be served, and settings that change: the server stays, and says so."""

import json
import signal


def test_agents_that_cannot_be_served_are_told_of_and_the_next_ones_are(serve):
    server = serve("traffic.max_vehicles=3", "traffic.recording=/nowhere.npz")
    server.announce(2)
    line = server.until("2 agents cannot be served: ")
    assert "/nowhere.npz: cannot read" in line
    assert line.startswith("eyas: warning: ")
    server.announce(1)
    server.until("1 agent cannot be served: ")
    assert server.process.poll() is None
    assert server.end(signal.SIGTERM) == 143


def test_more_agents_than_vehicles_do_not_end_the_server(serve):
    server = serve()
    server.announce(41)
    server.until("serving DRONE0 to DRONE40")
    for number in range(41):
        server.client(number).send("0,0,0,0,1\n")
    server.until("41 agents cannot be served: ")
    for _ in range(2):  # a second announcement of the same agents tries again
        server.announce(1)
        agent = server.client(0)
        assert agent.reset()[0][0] == 0.0
    assert agent.step()[0][0] == 4.0


def test_settings_that_change_are_read_when_agents_announce_themselves(tmp_path, serve):
    path = tmp_path / "dat/Webots_Simulation/traffic_project/config/env_config.json"
    path.parent.mkdir(parents=True)
    said = {"Tracker_Def": "DRONE", "Control_Frequence": 125, "Sumo_Params": {"keep_alive": True}}
    path.write_text(json.dumps(said))
    server = serve(root=tmp_path / "dat")
    server.announce(1)
    agent = server.client(0)
    agent.reset()
    assert agent.step()[0][0] == 4.0
    path.write_text(json.dumps({**said, "Control_Frequence": 250}))
    assert agent.step()[0][0] == 8.0  # nobody has announced himself
    server.announce(1)
    line = server.until("has changed: ")
    assert line.endswith("Control_Frequence is 250.0 (was 125.0)")
    agent.reset()
    assert agent.step()[0][0] == 2.0
    path.write_text("{")
    server.announce(2)
    assert "not valid JSON" in server.until("the settings read before still hold")
    server.until("serving DRONE0 to DRONE1")
