"""Controller of a drone: carries out its client's actions, and answers with packets and pictures.

While it waits for its client it makes no step, so that Webots' time stands still, as the original's
does. An action and a reset last the same number of steps, which is also the camera's period.
"""

import math
import os
import random
import sys
import time
from pathlib import Path
from typing import Any, NamedTuple

from eyas.dat.webots.controllers.ground import Ground, ground_of, settings_of
from eyas.dat.webots.controllers.tracking import STEP, Camera, Target, Tracker, line

_PAUSE = 0.0005  # Between two looks at a file [s]


class Request(NamedTuple):
    """What a client asks for."""

    command: tuple[float, float, float, float]
    """Forward [m/s], left [m/s], up [m per 2 ms], counter-clockwise [rad/s]."""
    reset: bool


def parsed(line: str) -> Request:
    """Return the request of a line `a0,a1,a2,a3,r`."""
    forward, left, up, turn, reset = map(float, line.split(","))
    return Request((forward, left, up, turn), reset == 1.0)


class Exchange:
    """The files of one tracker."""

    def __init__(
        self,
        folder: Path,  # The project's `Files2Alg`
        name: str,  # Of the tracker, such as `DRONE0`
    ) -> None:
        self._action = folder / f"{name}_AlgAction.txt"
        self._answers = [
            folder / f"{name}_{part}"
            for part in ("Ctrl2Global.txt", "RewardParams.txt", "PointCloud.txt")
        ]
        self.picture = folder / f"{name}_VideoFrame.jpeg"

    def request(self) -> Request:
        """Wait for the client's action; take it."""
        while True:
            try:
                text = self._action.read_text(encoding="ascii")
            except FileNotFoundError:
                text = ""
            if text.endswith("\n"):  # else it is being written
                self._action.unlink()
                return parsed(text)
            time.sleep(_PAUSE)

    def answer(self, lines: list[str | None]) -> None:
        """Give the basic, the reward and the radar packet, as far as there are any, each after the
        one before was read.
        """
        for path, text in zip(self._answers, lines, strict=True):
            if text is not None:
                part = path.with_suffix(".part")
                part.write_text(text + "\n", encoding="ascii")
                _given(part, path)

    def show(self, part: Path) -> None:
        """Give the picture that a file holds."""
        _given(part, self.picture)


def _given(part: Path, path: Path) -> None:
    while path.exists():
        time.sleep(_PAUSE)
    os.replace(part, path)
    while path.exists():
        time.sleep(_PAUSE)


_GONE = 5_000.0  # East coordinate beyond which vehicles wait [m]
_QUALITY = 100


class Drone:
    """One drone in Webots.

    Args:
        robot: Webots' `Supervisor`.
        number: Of the drone.
        project: The project's folder.
    """

    def __init__(self, robot: Any, number: int, project: Path) -> None:  # noqa: ANN401
        self._robot, self._node = robot, robot.getSelf()
        self._settings = settings_of(project)
        name = f"{self._settings['Tracker_Def']}{number}"
        folder = project / "Files2Alg"
        self._exchange, self._part = Exchange(folder, name), folder / f"{name}_picture.part.jpeg"
        self._basic_step = round(1000 * STEP)
        self._steps = int(500 / self._settings["Control_Frequence"])
        self._enable()
        roads = robot.getFromDef("SUMO_INTERFACE").getField("networkFiles").getSFString()
        self._ground: Ground = ground_of(Path(robot.getWorldPath()).parent / roads)
        width, height = self._camera.getWidth(), self._camera.getHeight()
        camera = Camera(width, height, self._camera.getFov())
        seed = self._settings["Sumo_Params"]
        chance = random.Random(seed["random_seed"] + number if seed["fixed_seed"] else None)
        self._chance = chance
        self.tracker = Tracker(self._settings, camera, self._ground.floor, chance)
        self._target: Any = None
        self._name = ""
        self._last: Target | None = None

    def _enable(self) -> None:
        robot, period = self._robot, self._steps * self._basic_step
        self._camera = robot.getDevice("camera")
        self._camera.enable(period)
        self._motor = robot.getDevice("camera pitch")
        self._lidar = None
        if self._settings["Lidar_Enable"]:
            self._lidar = robot.getDevice("lidar")
            self._lidar.enable(period)
            self._lidar.enablePointCloud()

    def run(self) -> None:
        """Serve the client until Webots ends."""
        while True:
            request = self._exchange.request()
            going = self._begin() if request.reset else self._act(request.command)
            if not going:
                return
            self._answer()

    def _act(self, command: tuple[float, float, float, float]) -> bool:
        if self._last is None and not self._begin():  # whatever it asks for first
            return False
        for _ in range(self._steps):
            before = self._last
            assert before is not None
            now = self._followed()
            self.tracker.advance(command, before, now)
            self._last = now or before
            self._place()
            if self._robot.step(self._basic_step) == -1:
                return False
        return True

    def _begin(self) -> bool:
        """Choose a target that nobody else follows, and start behind it."""
        while not self._choose():
            if self._robot.step(self._basic_step) == -1:
                return False
        self._last = self._followed()
        assert self._last is not None
        self.tracker.begin(self._last)
        self._place()
        return all(self._robot.step(self._basic_step) != -1 for _ in range(self._steps))

    def _choose(self) -> bool:
        robot, taken, number = self._robot, set(), 0
        while (other := robot.getFromDef(f"{self._settings['Tracker_Def']}{number}")) is not None:
            if other.getId() != self._node.getId():
                taken.add(other.getField("customData").getSFString())
            number += 1
        free, number = [], 0
        while (node := robot.getFromDef(f"SUMO_VEHICLE{number}")) is not None:
            here = node.getField("translation").getSFVec3f()[0] < _GONE
            if here and node.getDef() not in taken:
                free.append(node)
            number += 1
        if not free:
            return False
        self._target = self._chance.choice(free)
        self._name = self._target.getField("name").getSFString()
        self._node.getField("customData").setSFString(self._target.getDef())
        return True

    def _followed(self) -> Target | None:
        """Return the target; None if its vehicle has left, also if another has taken its node."""
        node = self._target
        x, y, z = node.getField("translation").getSFVec3f()
        if x >= _GONE or node.getField("name").getSFString() != self._name:
            return None
        *axis, angle = node.getField("rotation").getSFRotation()
        yaw = math.copysign(angle, axis[2]) if angle else 0.0
        ground = self._ground.floor + self._ground.above_floor(x, y)
        kind = node.getField("children").getMFNode(0).getTypeName()
        return Target((x, y, z), yaw, ground, kind)

    def _place(self) -> None:
        tracker = self.tracker
        self._node.getField("translation").setSFVec3f(list(tracker.position))
        self._node.getField("rotation").setSFRotation([0.0, 0.0, 1.0, tracker.yaw])
        self._motor.setPosition(tracker.pitch)

    def _answer(self) -> None:
        custom = self.tracker.custom() if self._settings["Customized_Rewards"] else None
        radar = None
        if self._lidar is not None:
            points = self._lidar.getPointCloud()
            radar = line([part for p in points for part in (p.x, p.y, p.z, 0.0, p.time)])
        self._exchange.answer([self.tracker.basic(), custom, radar])
        self._camera.saveImage(str(self._part), _QUALITY)
        self._exchange.show(self._part)


def main() -> None:
    """Serve one drone; the argument is its number."""
    from controller import Supervisor

    Drone(Supervisor(), int(sys.argv[1]), Path(__file__).parents[2]).run()


if __name__ == "__main__":
    main()
