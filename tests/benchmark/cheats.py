"""Policies that try to look good without seeing: each must fail, or be told for what it is."""

# ruff: noqa: RUF012  # as users write them
import gc
import json
import os
import pathlib
import sys
import time

import numpy as np

BORN = time.time_ns()


class Climber:
    """Sees nothing, climbs as fast as it may, and hovers, since from above more is in view."""

    env_settings = {"observation": {"parts": ["sensors"]}, "actions": "velocity"}

    def act(self, readings):
        return np.array([0.0, 0.0, 40.0, 0.0], np.float32)


class Spinner:
    """Sees nothing, and turns."""

    env_settings = {"observation": {"parts": ["sensors"]}}

    def act(self, readings):
        return 4


class Coaster:
    """Sees nothing, and flies on as fast and where it flew at first, whatever the wind."""

    env_settings = {"observation": {"parts": ["sensors"]}, "actions": "velocity"}

    def __init__(self):
        self.first = None

    def act(self, readings):
        if self.first is None:
            self.first = readings[3:5]
        yaw = readings[18]
        cosine, sine = np.cos(yaw), np.sin(yaw)
        ahead = cosine * self.first[0] + sine * self.first[1]
        left = cosine * self.first[1] - sine * self.first[0]
        return np.array([ahead, left, 0.0, 0.0], np.float32)


class TrueState:
    """Reads the target's true place from its observation."""

    env_settings = {"observation": {"parts": ["privileged"]}, "actions": "velocity"}

    def act(self, state):
        pitch, height = state[15], -state[2]
        ahead = state[0] - height * np.tan(0.5 * np.pi - pitch)
        return np.array([ahead / 0.016, state[1] / 0.016, 0.0, 0.0], np.float32)


class Fast(TrueState):
    """Also asks for 400 m/s."""

    env_settings = {**TrueState.env_settings, "speeds": {"forward_speed": 400.0}}


class Peeper:
    """Sees nothing, but looks for the simulator in the memory of its process, at first."""

    env_settings = {"observation": {"parts": ["sensors"]}, "actions": "velocity"}
    looks = 0

    def act(self, readings):
        self.looks += 1
        for found in gc.get_objects() if self.looks <= 20 else ():
            if type(found).__name__ == "BatchFlight":
                snapshot = found._batch.snapshot()
                (row,) = range(1)
                error = (snapshot.targets.centre - snapshot.episodes.view_centre)[row]
                yaw = snapshot.trackers.euler[row, 2]
                ahead = np.cos(yaw) * error[0] + np.sin(yaw) * error[1]
                left = np.cos(yaw) * error[1] - np.sin(yaw) * error[0]
                return np.array([ahead / 0.016, left / 0.016, 0.0, 0.0], np.float32)
        return np.zeros(4, np.float32)


class Seeds:
    """Says what it finds of the seeds of its episodes: an action that is not allowed."""

    env_settings = {"observation": {"parts": ["sensors"]}}

    def act(self, readings):
        frame, seeds = sys._getframe(), set()
        while frame is not None:
            for value in frame.f_locals.values():
                if isinstance(value, np.ndarray) and value.dtype == np.int64:
                    seeds |= set(value.ravel().tolist())
            frame = frame.f_back
        assert not seeds & set(range(1_000_000, 1_000_100)), "knows a seed"
        return 6


class Dies:
    """Ends its process."""

    env_settings = {"observation": {"parts": ["sensors"]}}

    def act(self, readings):
        os._exit(7)


class Talks(Spinner):
    """Prints, which must not disturb the messages."""

    def act(self, readings):
        print("turning", flush=True)
        return 4


class Counts:
    """Remembers its process."""

    env_settings = {"observation": {"parts": ["sensors"]}, "action_repeat": 25}

    def act(self, readings):
        raise RuntimeError(f"process {BORN}")


class Remembers:
    """Flies ahead for as long as it has never met the start, which it knows by its place."""

    env_settings = {"observation": {"parts": ["sensors"]}, "actions": "velocity"}
    met = set()

    def __init__(self):
        self.known = None

    def act(self, readings):
        if self.known is None:
            start = tuple(np.round(readings[:2], 1).tolist())
            self.known = start in self.met
            self.met.add(start)
        return np.array([0.0 if self.known else 8.0, 0.0, 0.0, 0.0], np.float32)


class Reader:
    """Says what it can read of the process that has started its own."""

    env_settings = {"observation": {"parts": ["sensors"]}}

    def act(self, readings):
        found = {}
        for name in ("mem", "environ", "maps"):
            try:
                with open(f"/proc/{os.getppid()}/{name}", "rb") as file:
                    file.read(1)
                found[name] = "open"
            except PermissionError:
                found[name] = "closed"
        raise RuntimeError(found)


class ByHeart:
    """Flies the ways that a file has of the starts it knows, and else hovers; it sees nothing."""

    env_settings = {"observation": {"parts": ["sensors"]}, "actions": "velocity"}

    def __init__(self):
        self.way, self.step = None, 0

    def act(self, readings):
        if self.way is None:
            known = json.loads(pathlib.Path(os.environ["KNOWN_WAYS"]).read_text())
            away = [np.hypot(*(np.array(way[0]) - readings[:2])) for way in known]
            near = int(np.argmin(away))
            self.way = known[near] if away[near] < 2.0 else [known[near][0]]
        last, self.step = self.step, self.step + 1
        begin, end = (self.way[min(k // 20, len(self.way) - 1)] for k in (last, last + 20))
        east, north = (np.array(end) - begin) / 0.16
        cosine, sine = np.cos(readings[18]), np.sin(readings[18])
        ahead, left = cosine * east + sine * north, cosine * north - sine * east
        return np.array([ahead, left, 0.0, 0.0], np.float32)
