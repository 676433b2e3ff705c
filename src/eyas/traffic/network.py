"""Road networks: SUMO's netconvert builds lanes and junctions from the road graph of a map."""

import hashlib
import subprocess
from collections import Counter
from xml.etree import ElementTree

import numpy as np

from eyas.core.errors import ConfigError
from eyas.core.scratch import scratch
from eyas.state.roads import RoadEdge, RoadGraph, RoadNetwork, RoadNode
from eyas.traffic.net_file import SumoNet, joined, points_of, road_network
from eyas.traffic.sumo_install import sumo_binary, sumo_environment, sumo_version

__all__ = ["OPTIONS", "build_network", "graph_hash", "network_xml", "without_comments"]

OPTIONS = (
    # Keep the world coordinates of the map.
    *("--offset.disable-normalization", "true"),
    # Smooth corners, wide enough for a crossing between the stop line and the junction's middle.
    *("--junctions.corner-detail", "8"),
    *("--junctions.internal-link-detail", "20"),
    *("--default.junctions.radius", "7"),
    # Cars slow down in turns: 5.5 m/s^2 sideways, as in the original's networks.
    *("--junctions.limit-turn-speed", "5.5"),
    # No U-turns at junctions; every road leads on, so none are needed.
    *("--no-turnarounds", "true"),
    *("--output.street-names", "false"),
    *("--precision", "3"),
)
"""netconvert's options, except its files."""


def graph_hash(graph: RoadGraph) -> str:
    """Return the SHA-256 of netconvert's whole input for a graph, options included."""
    if graph.finished:
        return hashlib.sha256(graph.finished).hexdigest()
    told = "\n".join([_node_xml(graph.nodes), _edge_xml(graph.edges), *OPTIONS])
    return hashlib.sha256(told.encode()).hexdigest()


def build_network(graph: RoadGraph) -> RoadNetwork:
    """Return the network of a graph, built by netconvert.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: Two nodes or edges have one name, or netconvert rejects the graph.
    """
    if graph.finished:
        return road_network(SumoNet(graph.finished), graph_hash(graph))
    net = SumoNet(network_xml(graph))
    found = {edge.name: edge for edge in net.edges}
    lanes = [
        (number, index, lane)
        for number, edge in enumerate(graph.edges)
        for index, lane in enumerate(found[edge.name].lanes if edge.name in found else ())
    ]
    lane_points, lane_first = joined([lane.points for _, _, lane in lanes])
    corners = [points_of(net.junctions.get(node.name, "")) for node in graph.nodes]
    junction_points, junction_first = joined(corners)
    return RoadNetwork(
        graph_hash=graph_hash(graph),
        builder=f"netconvert {sumo_version()}",
        lane_points=lane_points,
        lane_first=lane_first,
        lane_width=np.array([lane.width for _, _, lane in lanes]),
        lane_speed=np.array([lane.speed for _, _, lane in lanes]),
        lane_edge=np.array([edge for edge, _, _ in lanes], np.int32),
        lane_index=np.array([index for _, index, _ in lanes], np.int32),
        edges=tuple(edge.name for edge in graph.edges),
        edge_start=tuple(edge.start for edge in graph.edges),
        edge_end=tuple(edge.end for edge in graph.edges),
        junction_points=junction_points,
        junction_first=junction_first,
        junctions=tuple(node.name for node in graph.nodes),
    )


def network_xml(graph: RoadGraph, *, turnarounds: bool = False) -> bytes:
    """Return SUMO's network file of a graph; equal graphs give equal bytes.

    Args:
        graph: The roads.
        turnarounds: Whether one can turn round at junctions. Lanes and junctions are the same.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: Two nodes or edges have one name, or netconvert rejects the graph.
    """
    if graph.finished:
        return graph.finished
    for kind, names in (("node", graph.nodes), ("edge", graph.edges)):
        twice = [name for name, count in Counter(one.name for one in names).items() if count > 1]
        if twice:
            raise ConfigError(
                f"roads of '{graph.map_name}': {kind} '{twice[0]}' is there twice; each needs a "
                "name of its own"
            )
    netconvert = sumo_binary("netconvert")
    with scratch() as folder:
        nodes, edges, out = (folder / name for name in ("nod.xml", "edg.xml", "net.xml"))
        nodes.write_text(_node_xml(graph.nodes), encoding="utf-8")
        edges.write_text(_edge_xml(graph.edges), encoding="utf-8")
        files = ("-n", str(nodes), "-e", str(edges), "-o", str(out))
        banned = OPTIONS.index("--no-turnarounds")
        options = OPTIONS[:banned] + OPTIONS[banned + 2 :] if turnarounds else OPTIONS
        done = subprocess.run(
            [str(netconvert), *files, *options],
            env=sumo_environment(),
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != 0:
            reason = (done.stderr.strip().splitlines() or ["no message"])[0]
            raise ConfigError(f"roads of '{graph.map_name}': netconvert refuses them: {reason}")
        return without_comments(out.read_bytes())


def without_comments(xml: bytes) -> bytes:
    """Remove the comment with the time and temporary folder; the parser skips comments."""
    root = ElementTree.fromstring(xml)
    return bytes(ElementTree.tostring(root, encoding="utf-8")) + b"\n"


_ESCAPED = str.maketrans(
    {
        "&": "&amp;",
        "<": "&lt;",
        ">": "&gt;",
        '"': "&quot;",
        "\n": "&#10;",
        "\r": "&#13;",
        "\t": "&#9;",
    }
)


def _quoted(name: str) -> str:
    """Return the value of an attribute; `xml.sax.saxutils` would import an HTTP client with it."""
    return f'"{name.translate(_ESCAPED)}"'


def _node_xml(nodes: tuple[RoadNode, ...]) -> str:
    lines = [
        f'<node id={_quoted(node.name)} x="{node.x:.3f}" y="{node.y:.3f}" type="priority"/>'
        for node in nodes
    ]
    return "\n".join(["<nodes>", *lines, "</nodes>"])


def _edge_xml(edges: tuple[RoadEdge, ...]) -> str:
    lines = []
    for edge in edges:
        shape = " ".join(f"{x:.3f},{y:.3f}" for x, y in edge.shape)
        middle = f' shape="{shape}"' if shape else ""
        lines.append(
            f"<edge id={_quoted(edge.name)} from={_quoted(edge.start)} "
            f'to={_quoted(edge.end)} numLanes="{edge.lanes}" width="{edge.lane_width:.3f}" '
            f'speed="{edge.speed:.3f}"{middle}/>'
        )
    return "\n".join(["<edges>", *lines, "</edges>"])
