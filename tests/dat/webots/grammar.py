"""A reader of Webots' worlds and PROTOs that refuses what the reference does not allow.

Written from the published reference alone (see nodes.py, and reference/proto-definition.md,
def-and-use.md, indexedfaceset.md, elevationgrid.md); it shares no code with what writes the files.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from .nodes import BOUNDING, CHILDREN, CHOICES, FIELDS, GEOMETRIES, RANGES, SOLIDS

HEADER = "#VRML_SIM R2023b utf8"
TYPES = {
    f"{many}{one}"
    for many in ("SF", "MF")
    for one in ("Node", "Color", "Float", "Int32", "String", "Vec2f", "Vec3f", "Rotation", "Bool")
}
WIDTH = {"Vec2f": 2, "Vec3f": 3, "Color": 3, "Rotation": 4, "Float": 1, "Int32": 1}
_TOKEN = re.compile(r'[\s,]*(?:#[^\n]*\n|("(?:[^"\\]|\\.)*")|([\[\]{}])|([^\s,#"\[\]{}]+))')


@dataclass
class Node:
    kind: str
    fields: dict = field(default_factory=dict)
    name: str = ""
    taken: dict = field(default_factory=dict)  # of a PROTO: field -> its name there

    def __getitem__(self, name):
        return self.fields[name]

    def get(self, name, default=None):
        return self.fields.get(name, default)


@dataclass
class Proto:
    name: str
    fields: dict  # name -> type
    defaults: dict
    body: Node


class Reader:
    def __init__(self, text, protos=()):
        assert text.startswith(HEADER + "\n"), "the header"
        self.tokens, self.at = [], 0
        place = len(HEADER)
        while found := _TOKEN.match(text, place):
            place = found.end()
            token = next((part for part in found.groups() if part), None)
            if token is not None:
                self.tokens.append(token)
        assert not text[place:].strip(" \n,"), text[place : place + 40]
        self.protos = {proto.name: proto for proto in protos}
        self.named, self.interface = {}, None

    def world(self):
        """Return the nodes, and the paths after EXTERNPROTO and after IMPORTABLE."""
        heads, nodes = {False: [], True: []}, []
        while self.more():
            importable = self.peek() == "IMPORTABLE"
            if importable or self.peek() == "EXTERNPROTO":
                assert not nodes, "EXTERNPROTO stands before all nodes"
                self.at += importable
                assert self.take() == "EXTERNPROTO"
                heads[importable].append(self.string())
            else:
                nodes.append(self.node())
        return nodes, heads[False], heads[True]

    def proto(self):
        assert self.take() == "PROTO"
        name, fields, defaults, connected = self.take(), {}, {}, set()
        assert self.take() == "["
        while self.peek() != "]":
            word, kind, each = self.take(), self.take(), self.take()
            assert word in ("field", "unconnectedField"), word
            assert kind in TYPES, kind
            assert each not in fields, each
            fields[each], defaults[each] = kind, self.value(kind)
            connected |= {each} if word == "field" else set()
        self.at += 1
        self.interface, self.used = fields, set()
        assert self.take() == "{"
        body = self.node()
        assert self.take() == "}"
        assert not self.more()
        assert self.used == connected, "each field is taken by IS, or told to be unconnected"
        return Proto(name, fields, defaults, body)

    def node(self, above=()):
        if self.peek() == "USE":
            self.at += 1
            node = self.named[self.take()]
            assert node.kind not in SOLIDS | {"HingeJoint"}, f"USE of a {node.kind}"
            return node
        name = ""
        if self.peek() == "DEF":
            self.at += 1
            name = self.take()
            assert re.fullmatch(r"[A-Za-z]\w*", name), name
            assert name not in self.named, f"DEF {name} twice"
        kind = self.take()
        known = self.protos[kind].fields if kind in self.protos else None
        table = FIELDS.get(kind) if known is None else {n: (t,) for n, t in known.items()}
        assert table is not None, f"no node {kind}"
        base = kind if known is None else self.protos[kind].body.kind
        assert not (base in SOLIDS and "Transform" in above), f"{kind} below a Transform"
        node = Node(kind, {}, name)
        assert self.take() == "{", kind
        while self.peek() != "}":
            each = self.take()
            assert each in table, f"{kind} has no field {each}"
            assert each not in node.fields | node.taken, f"{kind}.{each} twice"
            if self.peek() == "IS":
                self.at += 1
                theirs = self.take()
                assert self.interface is not None, "IS outside of a PROTO"
                assert self.interface[theirs] == table[each][0], f"{kind}.{each} IS {theirs}"
                self.used.add(theirs)
                node.taken[each] = theirs
                continue
            inside = (*above, kind, *(["bounding"] if "bounding" in table[each] else []))
            node.fields[each] = self.value(table[each][0], inside)
            self.check(node, each, table[each], "bounding" in above)
        self.at += 1
        self.whole(node)
        if name:
            self.named[name] = node
        return node

    def check(self, node, each, rule, touched):
        place, value = f"{node.kind}.{each}", node.fields[each]
        if (node.kind, each) in CHOICES:
            assert value in CHOICES[node.kind, each], place
        if (node.kind, each) in RANGES:
            low, high = RANGES[node.kind, each]
            assert low <= value <= high, f"{place} {value}"
        if rule[0].endswith("Color"):
            assert ((np.array(value) >= 0) & (np.array(value) <= 1)).all(), place
        if rule[0] == "SFRotation":
            assert abs(np.linalg.norm(value[:3]) - 1) < 1e-6, f"{place}: a unit axis"
        if each == "scale":
            assert (np.array(value) > 0).all(), place
        allowed = rule[1] if len(rule) > 1 else ""
        sets = {"*": CHILDREN, "bounding": BOUNDING, "geometry": GEOMETRIES}
        kinds = sets.get(allowed, set(allowed.split(",")) if allowed else None)
        if kinds is not None and value is not None and not touched:
            for child in value if isinstance(value, list) else [value]:
                base = (
                    self.protos[child.kind].body.kind if child.kind in self.protos else child.kind
                )
                assert base in kinds, f"{place} holds a {child.kind}"
                if allowed == "bounding":
                    self.bounding(child)

    def bounding(self, node, depth=0):
        assert node.kind in BOUNDING, f"{node.kind} in a boundingObject"
        assert depth < 4
        for child in node.get("children") or []:
            self.bounding(child, depth + 1)

    def whole(self, node):
        """Check what holds between the fields of a node."""
        if node.kind == "IndexedFaceSet":
            faces = node["coordIndex"].reshape(-1, 4)
            assert (faces[:, 3] == -1).all(), "each face is a triangle"
            for name, inner in (("coord", "point"), ("normal", "vector"), ("texCoord", "point")):
                if name in node.fields:
                    index = node[f"{name}Index"].reshape(-1, 4)
                    assert index.shape == faces.shape, name
                    assert (index[:, 3] == -1).all(), name
                    assert index[:, :3].min() >= 0, name
                    assert index[:, :3].max() == len(node[name][inner]) - 1, name
            corners = node["coord"]["point"][faces[:, :3]]
            for a, b in ((0, 1), (1, 2), (2, 0)):
                assert (corners[:, a] != corners[:, b]).any(axis=1).all(), "corners coincide"
        if node.kind == "ElevationGrid":
            assert len(node["height"]) == node["xDimension"] * node["yDimension"]
            assert min(node["xDimension"], node["yDimension"]) >= 2
            assert min(node["xSpacing"], node["ySpacing"]) > 0

    def value(self, kind, above=()):
        many, one = kind[:2] == "MF", kind[2:]
        if one in WIDTH:
            return self.numbers(one, many)
        single = {
            "Node": lambda: self.node_or_null(above),
            "String": self.string,
            "Bool": self.truth,
        }
        if not many:
            return single[one]()
        if self.peek() != "[":
            return [single[one]()]
        self.at += 1
        values = []
        while self.peek() != "]":
            values.append(single[one]())
        self.at += 1
        return values

    def node_or_null(self, above):
        if self.peek() == "NULL":
            self.at += 1
            return None
        return self.node(above)

    def numbers(self, one, many):
        convert, width = (int if one == "Int32" else float), WIDTH[one]
        if not many:
            values = [convert(self.take()) for _ in range(width)]
            return values[0] if width == 1 else tuple(values)
        assert self.peek() == "[", "a list"
        end = self.tokens.index("]", self.at)
        words = self.tokens[self.at + 1 : end]
        self.at = end + 1
        array = np.array([convert(word) for word in words])
        assert np.isfinite(array).all()
        return array if width == 1 else array.reshape(-1, width)

    def string(self):
        token = self.take()
        assert token.startswith('"'), token
        return token[1:-1]

    def truth(self):
        return {"TRUE": True, "FALSE": False}[self.take()]

    def more(self):
        return self.at < len(self.tokens)

    def peek(self):
        return self.tokens[self.at]

    def take(self):
        self.at += 1
        return self.tokens[self.at - 1]
