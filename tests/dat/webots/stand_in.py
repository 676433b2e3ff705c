"""What stands in for Webots: the world file's nodes, and the part of its `Supervisor` that our
controllers call (https://cyberbotics.com/doc/reference/supervisor). Solids move by their velocity.
"""

from pathlib import Path

import numpy as np
from PIL import Image

from .grammar import HEADER, Node, Reader

_DEFAULTS = {"translation": (0.0, 0.0, 0.0), "rotation": (0.0, 0.0, 1.0, 0.0), "customData": ""}


class World:
    def __init__(self, path, protos, nodes):
        self.path, self.protos, self.nodes = Path(path), protos, nodes
        self.time, self.each_step = 0, []

    def find(self, name):
        return next((node for node in self.nodes if node.name == name), None)

    def value(self, node, name):
        if name in node.fields:
            return node.fields[name]
        proto = next((proto for proto in self.protos if proto.name == node.kind), None)
        return proto.defaults[name] if proto else _DEFAULTS[name]

    def advance(self, period):
        for node in self.nodes:
            speed = node.fields.get("velocity")
            if speed:
                place = np.array(node["translation"]) + 0.001 * period * np.array(speed[:3])
                node.fields["translation"] = tuple(place.tolist())
        self.time += period
        for call in self.each_step:
            call(self.time)


class Field:
    def __init__(self, world, node, name):
        self._world, self._node, self._name = world, node, name

    def _get(self):
        return self._world.value(self._node, self._name)

    def _set(self, value):
        self._node.fields[self._name] = tuple(value) if isinstance(value, list) else value

    getSFVec3f = getSFRotation = getSFString = getSFInt32 = _get  # noqa: N815
    setSFVec3f = setSFRotation = setSFString = _set  # noqa: N815

    def getMFNode(self, index):  # noqa: N802
        return Handle(self._world, self._get()[index])

    def importMFNodeFromString(self, index, text):  # noqa: N802
        assert index == -1
        (node,), _, _ = Reader(f"{HEADER}\n{text}", self._world.protos).world()
        self._world.nodes.append(node)


class Handle:
    def __init__(self, world, node):
        self._world, self._node = world, node

    def getField(self, name):  # noqa: N802
        return Field(self._world, self._node, name)

    def getDef(self):  # noqa: N802
        return self._node.name

    def getId(self):  # noqa: N802
        return id(self._node)

    def getTypeName(self):  # noqa: N802
        return self._node.kind

    def setVelocity(self, velocity):  # noqa: N802
        self._node.fields["velocity"] = velocity


class Device:
    """A camera of 64 x 48 pixels, or a motor."""

    position = 0.0

    def enable(self, period):
        self.period = period

    def getWidth(self):  # noqa: N802
        return 64

    def getHeight(self):  # noqa: N802
        return 48

    def getFov(self):  # noqa: N802
        return 0.7854

    def setPosition(self, position):  # noqa: N802
        self.position = position

    def saveImage(self, path, quality):  # noqa: N802
        Image.new("RGB", (64, 48), (9, 9, 9)).save(path, quality=quality)


class Supervisor:
    """The robot with a DEF name; it ends when `steps` have been made."""

    def __init__(self, world, name, steps=10**9):
        self._world, self._name, self._left = world, name, steps
        self.devices = {}

    def getSelf(self):  # noqa: N802
        return self.getFromDef(self._name)

    def getRoot(self):  # noqa: N802
        return Handle(self._world, Node("Group", {"children": self._world.nodes}))

    def getFromDef(self, name):  # noqa: N802
        node = self._world.find(name)
        return None if node is None else Handle(self._world, node)

    def getDevice(self, name):  # noqa: N802
        return self.devices.setdefault(name, Device())

    def getWorldPath(self):  # noqa: N802
        return str(self._world.path)

    def step(self, period):
        if self._left <= 0:
            return -1
        self._left -= 1
        self._world.advance(period)
        return 0
