"""A training program as the three of the original, of which a test makes a checkout: it is started
in `Alg_Base/DAT_Benchmark`, finds everything by paths relative to that folder, starts `webots`
through the shell and announces its agents. It imports no Eyas, and learns nothing.
"""

import argparse
import json
import socket
import subprocess
import sys
import threading
import time

sys.path.append("./envs/communication")

from client import Client

SETTINGS = "../../Webots_Simulation/traffic_project/config/env_config.json"
WORLDS = "../../Webots_Simulation/traffic_project/worlds/"


def changed(path, change):
    with open(path) as file:
        values = json.load(file)
    change(values)
    with open(path, "w") as file:
        json.dump(values, file, indent=4)
    return values


def heard(port, agents):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        out.connect(("127.0.0.1", port))
        out.send(b"%d" % agents)
        out.settimeout(0.02)
        try:
            out.recv(1)
        except ConnectionRefusedError:
            return False
        except TimeoutError:
            return True


def learn(agent):
    client = Client("../..", agent, patience=900.0)
    client.reset()
    client.step((40.0, 0.0, 0.0, 0.0))


def main():
    parse = argparse.ArgumentParser()
    parse.add_argument("-w", "--workers", type=int, default=35)
    parse.add_argument("-m", "--map", default="citystreet-day.wbt")
    parse.add_argument("--Scene")
    parse.add_argument("--Weather")
    for mode in ("--train_mode", "--Mode"):
        parse.add_argument(mode, type=int, default=1)
    parse.add_argument("--New_Train", action="store_true")
    args = parse.parse_args()
    with socket.socket() as taken:
        taken.bind(("", 0))
        port = taken.getsockname()[1]
    changed(SETTINGS, lambda values: values.update(Config_Agen_Num_Port=port))
    changed("config.json", lambda values: values["Benchmark"].update(port_process=port))
    world = f"{args.Scene}-{args.Weather}.wbt" if args.Scene else args.map
    subprocess.Popen(f"webots --no-rendering --mode=fast {WORLDS}{world}", shell=True)
    while not heard(port, args.workers):  # the original sleeps for 20 s
        time.sleep(0.01)
    players = [threading.Thread(target=learn, args=(agent,)) for agent in range(args.workers)]
    for player in players:
        player.start()
    for player in players:
        player.join()
    print("trained", args.workers, "in", world, flush=True)


if __name__ == "__main__":
    main()
