"""Controller of the world: waits until clients tell how many they are, and adds as many drones."""

import re
import socket
from pathlib import Path
from typing import Any

from eyas.dat.webots.controllers.ground import settings_of

_STEP = 2  # [ms]
_MOST = 1024  # Largest number of drones, as in Eyas
_SPAWN = 'DEF {name} Drone {{ name "{name}" translation {at} {at} 0.15 controllerArgs [ "{k}" ] }}'


def serve(robot: Any, project: Path) -> None:  # noqa: ANN401  # Webots' `Supervisor`
    """Add the drones of all clients, and keep the world going until Webots ends."""
    settings, files = settings_of(project), project / "Files2Alg"
    if settings["Simulation_Mode"] != "train" or settings["Tracker_Def"] != "DRONE":
        print("env_config.json: this project knows Simulation_Mode train and Tracker_Def DRONE")
        return
    files.mkdir(exist_ok=True)
    for old in files.iterdir():
        if re.fullmatch(r"(DRONE\d+_|recv_action|start).*\.(txt|jpeg|part)", old.name):
            old.unlink()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        port.bind(("127.0.0.1", settings["Config_Agen_Num_Port"]))
        (files / "start.txt").write_text("b'1\\n'\n")
        count = _announced(port)
    warm = int(settings["Drone_Random_Config"]["start_time_bias_ms"]) + 6 * count
    for _ in range(warm):
        robot.step(_STEP)
    children = robot.getRoot().getField("children")
    for k in range(count):
        text = _SPAWN.format(name=f"DRONE{k}", at=k, k=k)
        children.importMFNodeFromString(-1, text)
    while robot.step(_STEP) != -1:
        pass


def _announced(port: socket.socket) -> int:
    """Wait until clients tell how many they are; other messages are passed over."""
    while True:
        text = port.recv(256).strip()
        if text.isdigit() and len(text) <= 4 and 1 <= int(text) <= _MOST:
            return int(text)
        print(f"message {text[:40]!r} ignored: not a number of agents, 1 to {_MOST}")


def main() -> None:
    """Serve the project that this file is in."""
    from controller import Supervisor

    serve(Supervisor(), Path(__file__).parents[2])


if __name__ == "__main__":
    main()
