"""Controller of the interface to SUMO: drives the vehicles of the world by TraCI.

It needs SUMO and its Python module `traci` (`pip install eclipse-sumo traci`).
"""

import math
import os
import shutil
import sys
import xml.etree.ElementTree as Xml
from pathlib import Path
from typing import Any

from eyas.dat.webots.controllers.ground import Ground, ground_of, settings_of

_STEP = 2  # [ms]
_AWAY = 10_000.0


def pose_of(
    front: tuple[float, float],  # Of its front bumper, as SUMO has it [m]
    angle: float,  # Of SUMO, clockwise from north [deg]
    length: float,  # Of the vehicle [m]
    offset: tuple[float, float],  # Of the network [m]
) -> tuple[float, float, float]:
    """Return east and north of a vehicle's middle [m] and its heading [rad]."""
    yaw = math.radians(90.0 - angle)
    x = front[0] - offset[0] - 0.5 * length * math.cos(yaw)
    y = front[1] - offset[1] - 0.5 * length * math.sin(yaw)
    return x, y, math.remainder(yaw, 2.0 * math.pi)


class Traffic:
    """The nodes of the vehicles in Webots, and which vehicle of SUMO, by TraCI, each is now."""

    def __init__(
        self,
        robot: Any,  # noqa: ANN401
        sumo: Any,  # noqa: ANN401
        ground: Ground,
        offset: tuple[float, float],
        most: int,
    ) -> None:
        self._sumo, self._ground, self._offset, self._most = sumo, ground, offset, most
        self._free: dict[str, list[Any]] = {}
        self._used: dict[str, Any] = {}
        self._parked: dict[str, list[float]] = {}
        number = 0
        while (node := robot.getFromDef(f"SUMO_VEHICLE{number}")) is not None:
            self._free.setdefault(node.getField("model").getSFString(), []).append(node)
            self._parked[node.getDef()] = list(node.getField("translation").getSFVec3f())
            number += 1

    def advance(self, period: float) -> None:
        """Let SUMO go on by a step, and the nodes after it, with the velocities to be there at its
        end.

        Args:
            period: Of a step [s].
        """
        before = {name: self._pose(name) for name in self._used}
        self._sumo.simulationStep()
        there = set(self._sumo.vehicle.getIDList())
        for name in sorted(set(self._used) - there):
            self._park(name)
        for name in sorted(there):
            node = self._used.get(name) or self._taken(name)
            if node is not None:
                now = self._pose(name)
                self._put(node, before.get(name, now), now, period)

    def _pose(self, name: str) -> tuple[float, float, float]:
        vehicle = self._sumo.vehicle
        if name not in vehicle.getIDList():
            return _AWAY, 0.0, 0.0
        front, angle = vehicle.getPosition(name), vehicle.getAngle(name)
        return pose_of(front, angle, vehicle.getLength(name), self._offset)

    def _taken(self, name: str) -> Any:  # noqa: ANN401
        """Return the node that a new vehicle gets; None if there is none left of its class."""
        free = self._free.get(self._sumo.vehicle.getVehicleClass(name), [])
        if not free or len(self._used) >= self._most:
            return None
        node = self._used[name] = free.pop(0)
        node.getField("name").setSFString(name)
        return node

    def _park(self, name: str) -> None:
        node = self._used.pop(name)
        number = int(node.getDef().removeprefix("SUMO_VEHICLE"))
        node.setVelocity([0.0] * 6)
        node.getField("translation").setSFVec3f(self._parked[node.getDef()])
        node.getField("name").setSFString(f"SUMO vehicle {number}")
        self._free[node.getField("model").getSFString()].append(node)

    def _put(
        self,
        node: Any,  # noqa: ANN401
        old: tuple[float, float, float],
        new: tuple[float, float, float],
        period: float,
    ) -> None:
        x, y, yaw = old
        rise = self._parked[node.getDef()][2]  # where it waits it is as high as its wheels' middles
        z = self._ground.above_floor(x, y)
        climb = self._ground.above_floor(new[0], new[1]) - z
        turn = math.remainder(new[2] - yaw, 2.0 * math.pi) / period
        axis = 1.0 if yaw >= 0.0 else -1.0
        node.getField("translation").setSFVec3f([x, y, z + rise])
        node.getField("rotation").setSFRotation([0.0, 0.0, axis, abs(yaw)])
        speed = [(new[0] - x) / period, (new[1] - y) / period, climb / period]
        node.setVelocity([*speed, 0.0, 0.0, turn])


def _offset_of(network: Path) -> tuple[float, float]:
    """Return the offset that a network file tells [m]."""
    for _, element in Xml.iterparse(network):
        if element.tag == "location":
            x, y = element.attrib["netOffset"].split(",")
            return float(x), float(y)
    raise ValueError(f"{network}: no location")


def main() -> None:
    """Drive the traffic of the world that this robot is in."""
    if "SUMO_HOME" in os.environ:
        sys.path.append(os.path.join(os.environ["SUMO_HOME"], "tools"))
    import traci
    from controller import Supervisor

    robot, project = Supervisor(), Path(__file__).parents[2]
    node, settings = robot.getSelf(), settings_of(project)["Sumo_Params"]
    world = Path(robot.getWorldPath())
    folder = world.parent / node.getField("networkFiles").getSFString()
    step = node.getField("step").getSFInt32()
    seed = ["--seed", str(settings["random_seed"])] if settings["fixed_seed"] else ["--random"]
    program = shutil.which("sumo") or os.path.join(os.environ.get("SUMO_HOME", ""), "bin", "sumo")
    told = ["-c", str(folder / "sumo.sumocfg"), "--step-length", f"{step / 1000:g}"]
    traci.start([program, *told, *seed])
    offset = _offset_of(folder / "sumo.net.xml")
    traffic = Traffic(robot, traci, ground_of(folder), offset, settings["max_sumo_car"])
    while True:
        traffic.advance(step / 1000)
        for _ in range(step // _STEP):
            if robot.step(_STEP) == -1:
                traci.close()
                return


if __name__ == "__main__":
    main()
