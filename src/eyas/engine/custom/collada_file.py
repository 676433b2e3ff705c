"""Checks of COLLADA files before trimesh reads them with pycollada."""

import math
from xml.etree import ElementTree

from eyas.engine.core.decoding import decoded_xml

_MOST = 256 << 20  # Largest text of all that is shown, counted as often as it is [characters]
_NODE = 4096  # What a node counts as [characters]
_DEEPEST = 64  # Largest nesting of nodes


def checked_collada(content: bytes) -> tuple[bytes, str, float]:
    """Return a file's content in UTF-8, its axis that is up, `y` or `z`, and its unit [m].

    Raises:
        ValueError: It is damaged, or shows nodes within nodes without end.
    """
    root = decoded_xml(content)
    space = root.tag.rpartition("}")[0] + "}" if root.tag.startswith("{") else ""
    if root.tag != f"{space}COLLADA":
        raise ValueError("its content is not <COLLADA>")
    asset = root.find(f"{space}asset")
    unit = None if asset is None else asset.find(f"{space}unit")
    up = "Y_UP" if asset is None else asset.findtext(f"{space}up_axis", "Y_UP")
    metres = float("1" if unit is None else unit.get("meter", "1"))
    if not 0.0 < metres < math.inf:
        raise ValueError(f"its unit is {metres} m")
    _require_few(root, space)
    ElementTree.register_namespace("", space.strip("{}"))
    return ElementTree.tostring(root), "z" if up.strip() == "Z_UP" else "y", metres


def _require_few(root: ElementTree.Element, space: str) -> None:
    """Refuse what shows too much: nodes may name each other, and a geometry many times."""
    named = {
        each.get("id"): each
        for kind in ("node", "geometry")
        for each in root.iter(space + kind)
        if each.get("id")
    }
    sizes: dict[ElementTree.Element, int] = {}

    def size(each: ElementTree.Element, depth: int) -> int:
        if depth > _DEEPEST:
            raise ValueError("nodes nested too deep, or without end")
        if each not in sizes:
            if each.tag == f"{space}geometry":
                sizes[each] = sum(len(one.text or "") for one in each.iter())
            else:
                shown = [
                    child if child.tag == f"{space}node" else named.get(child.get("url", "")[1:])
                    for child in each
                ]
                parts = [size(one, depth + 1) for one in shown if one is not None]
                sizes[each] = _NODE + sum(parts)
        return sizes[each]

    if sum(size(one, 0) for scene in root.iter(f"{space}visual_scene") for one in scene) > _MOST:
        raise ValueError("it shows too much: its nodes show others, or a geometry, again and again")
