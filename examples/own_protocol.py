"""A wire protocol of your own: `python examples/own_protocol.py`.

A drone that is flown by lines of JSON over UDP, in lock-step: each datagram is a command that holds
for a control step, and is answered by what the drone is then. Any language can speak it:

    {"forward": 4.0, "left": 0.0, "up": 0.5, "turn": 0.2}
    {"time": 0.01, "position": [...], "heading": 1.57, "target": [...]}

Speeds are in the frame of the body [m/s], the turn is counter-clockwise [rad/s], and what is not
told is 0; places are east, north and up [m], the heading is from east to north [rad].

The loop of Eyas owns the time, moves the simulation, and reports what cannot be understood; the
face below only hears, orders and answers. To fly by the clock instead, leave out `speed`, and
return orders at all times.
"""

import json
import math
import socket
from collections.abc import Iterable
from contextlib import suppress
from threading import Thread
from typing import Any

import numpy as np

from eyas import (
    PHYSICS_STEP,
    Face,
    Orders,
    Simulation,
    build_simulation,
    make_config,
    serve,
    together,
)

Message = tuple[bytes, tuple[str, int]]

LARGEST = 1000
"""Longest datagram that is read whole [bytes]."""

FASTEST = 30.0
"""Largest number in a command."""

KEYS = ("forward", "left", "up", "turn")


class JsonLines(Face):
    """Commands in, states out, for whoever speaks.

    Args:
        simulation: One drone.
        port: UDP port of this machine; 0: any free one.
    """

    speed = 0.0  # as fast as commands come

    def __init__(self, simulation: Simulation, port: int = 0) -> None:
        self.simulation = simulation
        self.steps = round(1.0 / simulation.config.control.frequency / PHYSICS_STEP)
        self.time = 0.0
        self.command: list[float] | None = None
        self.peer = ("", 0)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        simulation.reset()

    def receive(self, wait: float) -> Iterable[tuple[str, Message]]:
        """Return the datagram that comes within a time [s]."""
        self.socket.settimeout(wait)
        try:
            line, peer = self.socket.recvfrom(LARGEST)
        except (TimeoutError, BlockingIOError, ConnectionError):
            return []
        return [(f"a line from {peer[0]}", (line, peer))]

    def take(self, message: Message) -> None:
        """Read a command; whatever is raised here becomes one line in the log."""
        line, peer = message
        told = json.loads(line)
        if not isinstance(told, dict) or set(told) - set(KEYS):
            raise ValueError(f"allowed: an object with {', '.join(KEYS)}")
        command = [float(told.get(key, 0.0)) for key in KEYS]
        if not all(abs(number) <= FASTEST for number in command):
            raise ValueError(f"allowed: numbers from -{FASTEST:g} to {FASTEST:g}")
        self.command, self.peer = command, peer

    def orders(self) -> Orders | None:
        """Return the command that has come; None: time stands still."""
        if self.command is None:
            return None
        forward, left, up, turn = self.command
        self.command = None
        return Orders(np.array([[forward, left, up * PHYSICS_STEP, turn]]), self.steps)

    def answer(self, *, late: bool) -> None:
        """Tell what the drone is now."""
        self.time += self.steps * PHYSICS_STEP
        state = self.simulation.snapshot
        told = {
            "time": round(self.time, 3),
            "position": state.trackers.position[0].tolist(),
            "heading": float(state.trackers.euler[0, 2]),
            "target": state.targets.position[0].tolist(),
        }
        with suppress(OSError):  # it came from where nobody can be answered
            self.socket.sendto(json.dumps(told).encode(), self.peer)

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()


def main() -> None:
    """Serve until nobody has spoken for a second, and fly towards the target meanwhile."""
    config = make_config()
    face = JsonLines(build_simulation(config, together(1)))
    place = face.socket.getsockname()
    server = Thread(target=serve, args=(face,), kwargs={"until_idle": 1.0})
    server.start()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.connect(place)
        turn = 0.0
        for step in range(200):
            client.send(json.dumps({"forward": 5.0, "turn": turn}).encode())
            told: dict[str, Any] = json.loads(client.recv(LARGEST))
            east, north = (told["target"][axis] - told["position"][axis] for axis in range(2))
            error = math.remainder(math.atan2(north, east) - told["heading"], 2.0 * math.pi)
            turn = max(-1.0, min(error, 1.0))
            if step % 50 == 49:
                print(f"after {told['time']} s the target is {math.hypot(east, north):.1f} m away")
    server.join()


if __name__ == "__main__":
    main()
