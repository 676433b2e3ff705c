"""A client of the original's protocol, written from its description alone; it imports no Eyas.

As a program it plays one agent: `client.py ROOT AGENT AGENTS PORT ROUNDS [PATIENCE]`, and prints
how it went.
A round is a step or a reset: all agents must send equally many of them.
"""

import io
import json
import socket
import sys
import time
from pathlib import Path

from PIL import Image

FILES = Path("Webots_Simulation", "traffic_project", "Files2Alg")
FORWARD = (40.0, 0.0, 0.0, 0.0)
HOVER = (0.0, 0.0, 0.0, 0.0)


class Client:
    """One agent. `patience` is the longest wait for a file [s]."""

    def __init__(self, root, agent, *, rewards=True, radar=False, tracker="DRONE", patience=60.0):
        name = f"{tracker}{agent}"
        self.folder = Path(root) / FILES
        self.action = self.folder / f"{name}_AlgAction.txt"
        self.state = self.folder / f"{name}_Ctrl2Global.txt"
        self.rewards = self.folder / f"{name}_RewardParams.txt" if rewards else None
        self.radar = self.folder / f"{name}_PointCloud.txt" if radar else None
        self.cloud = None
        self.picture = self.folder / f"{name}_VideoFrame.jpeg"
        self.patience = patience

    @staticmethod
    def announce(port, agents, message=None):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.sendto(f"{agents}\n".encode() if message is None else message, ("127.0.0.1", port))

    def step(self, action=HOVER):
        self.picture.unlink(missing_ok=True)
        return self._round(action, 0)

    def reset(self):
        self.state.unlink(missing_ok=True)
        return self._round(HOVER, 1)

    def _round(self, action, reset):
        """Send an action; return 22 numbers, the reward packet or None, and the JPEG's bytes."""
        self.send(",".join(map(str, (*action, reset))) + "\n")
        self.until(lambda: not self.action.exists())
        return self.answer()

    def send(self, line):
        with open(self.action, "wb") as file:
            file.write(line if isinstance(line, bytes) else line.encode())

    def answer(self):
        state = [float(word) for word in self.text(self.state).split(",")]
        assert len(state) == 22
        rewards = None
        if self.rewards is not None:
            *numbers, kind = self.text(self.rewards).split(",")
            assert len(numbers) == 60
            rewards = [*map(float, numbers), kind]
        if self.radar is not None:
            self.cloud = [float(word) for word in self.text(self.radar).split(",")]
            assert len(self.cloud) == 2000
        self.state.unlink(missing_ok=True)  # as the original: nothing may be there yet
        return state, rewards, self.take(self.picture)

    def text(self, path):
        text = self.take(path).decode("ascii")
        assert text.endswith("\n")
        return text.rstrip("\n")

    def take(self, path):
        """Wait for a file, read it and delete it."""
        self.until(path.exists)
        content = path.read_bytes()
        path.unlink()
        assert content, path
        return content

    def until(self, true):
        begun = time.monotonic()
        while not true():
            if time.monotonic() > begun + self.patience:  # which may be changed meanwhile
                raise TimeoutError("the simulator does not answer")
            time.sleep(0.001)  # as the original


def main(root, agent, agents, port, rounds, patience=60.0):
    """Play: turn with each agent's own speed, and reset after each end.

    The first answer comes when the server has built its world, which may take minutes where others
    have most of the processors.
    """
    client = Client(root, agent, patience=float(patience))
    client.announce(int(port), int(agents))
    state, _, _ = client.reset()
    print("begun", flush=True)
    begin, cpu, resets = time.monotonic(), time.process_time(), 0
    for _ in range(int(rounds)):
        if state[21] == 1.0:
            state, _, jpeg = client.reset()
            assert state[0] <= 80
            resets += 1
        else:
            state, _, jpeg = client.step((10.0, 0.0, 0.0, 0.1 * int(agent)))
        Image.open(io.BytesIO(jpeg)).load()
    cpu, seconds = time.process_time() - cpu, time.monotonic() - begin
    print(json.dumps({"seconds": seconds, "cpu": cpu, "resets": resets}))


if __name__ == "__main__":
    main(*sys.argv[1:])
