"""A training program as the original's are: it changes `env_config.json`, draws a free port, starts
`webots` through the shell, and only then announces its agents. It imports no Eyas.

`trainer.py DAT WORLD AGENTS ROUNDS` prints the port, and when it is done `trained`.
"""

import json
import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, os.path.dirname(__file__))

from client import FILES, Client  # beside this file

SETTINGS = Path("Webots_Simulation", "traffic_project", "config", "env_config.json")


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("", 0))
        return taken.getsockname()[1]


def train(root, agent, rounds):
    client = Client(root, agent, patience=900.0)
    client.reset()
    for _ in range(rounds):
        client.step((10.0, 0.0, 0.0, 0.0))


def main(root, world, agents, rounds):
    root = Path(root)
    settings = json.loads((root / SETTINGS).read_text())
    settings["Config_Agen_Num_Port"] = port = free_port()
    settings["Reward_Config"] = {"reward_mode": "discrete", "view_range": 0.55}
    (root / SETTINGS).write_text(json.dumps(settings))
    print(port, flush=True)
    folder = root / FILES
    command = f"webots --batch --mode=fast --no-rendering --minimize {world} &"
    subprocess.call(command, shell=True, cwd=root / "Webots_Simulation")
    end = time.monotonic() + 900.0
    while not (folder / "start.txt").exists():  # the original sleeps for so long as it is told
        assert time.monotonic() < end
        time.sleep(0.05)
    time.sleep(1.0)
    for _ in range(int(agents)):
        Client.announce(port, int(agents))
    players = [
        threading.Thread(target=train, args=(root, agent, int(rounds)))
        for agent in range(int(agents))
    ]
    for player in players:
        player.start()
    for player in players:
        player.join()
    print("trained", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
