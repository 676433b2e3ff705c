"""Road networks: SUMO's netconvert builds lanes and junctions from the road graph of a map."""

import hashlib
import subprocess
from collections import Counter
from collections.abc import Collection, Iterable
from xml.etree import ElementTree

import numpy as np

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.scratch import scratch
from eyas.engine.state.roads import LEFT_HAND, RoadEdge, RoadGraph, RoadNetwork, RoadNode
from eyas.engine.traffic.net_file import SumoNet, joined, points_of, road_network
from eyas.engine.traffic.sumo_install import sumo_binary, sumo_environment, sumo_version

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

_LEFT_HAND = ("--lefthand", "true")  # The same where traffic keeps left

STRAIGHT_FIRST = "slrtLR"
"""What a light shows is for those who drive on in the first of these directions that there is."""

_SIGNALS = (
    # All who come along a street have green together, so that one light tells all of them.
    *("--tls.left-green.time", "0"),
    *("--tls.cycle.time", "60"),
    *("--tls.allred.time", "2"),
)
"""The same for signals at junctions, if they are to work."""


def graph_hash(graph: RoadGraph) -> str:
    """Return the SHA-256 of netconvert's whole input for a graph, options included."""
    if graph.finished:
        return hashlib.sha256(graph.finished).hexdigest()
    options = (*OPTIONS, *_LEFT_HAND) if graph.left_hand else OPTIONS
    told = "\n".join([_node_xml(graph.nodes), _edge_xml(graph.edges), *options])
    return hashlib.sha256(told.encode()).hexdigest()


def build_network(graph: RoadGraph) -> RoadNetwork:
    """Return the network of a graph, built by netconvert.

    Raises:
        MissingExtraError: SUMO is not installed.
        ConfigError: Two nodes or edges have one name, or netconvert rejects the graph.
        DataFileError: A file with its roads is not a network of SUMO.
    """
    if graph.finished:
        return road_network(
            SumoNet(graph.finished, f"roads of '{graph.map_name}'"), graph_hash(graph)
        )
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
        builder=f"netconvert {sumo_version()}" + (LEFT_HAND if graph.left_hand else ""),
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


def network_xml(graph: RoadGraph, *, turnarounds: bool = False, signals: bool = False) -> bytes:
    """Return SUMO's network file of a graph; equal graphs give equal bytes.

    Lanes and junctions do not depend on the options.

    Args:
        graph: The roads.
        turnarounds: Whether one can turn round at junctions.
        signals: Whether there are traffic lights where at least three roads meet.

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
        lit = crossings((edge.start, edge.end) for edge in graph.edges) if signals else set()
        nodes.write_text(_node_xml(graph.nodes, lit), encoding="utf-8")
        edges.write_text(_edge_xml(graph.edges), encoding="utf-8")
        files = ("-n", str(nodes), "-e", str(edges), "-o", str(out))
        banned = OPTIONS.index("--no-turnarounds")
        options = OPTIONS[:banned] + OPTIONS[banned + 2 :] if turnarounds else OPTIONS
        options = (*options, *_SIGNALS) if signals else options
        options = (*options, *_LEFT_HAND) if graph.left_hand else options
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
        return without_comments(out.read_bytes(), agreed=signals)


def without_comments(xml: bytes, *, agreed: bool = False) -> bytes:
    """Remove the comment with the time and temporary folder; the parser skips comments.

    Args:
        xml: SUMO's network file.
        agreed: Whether all who come along a street stand at red together. Else netconvert gives
            those green who cross nobody's way, as with an arrow to the right.
    """
    root = ElementTree.fromstring(xml)
    if agreed:
        _agree(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8")) + b"\n"


def _agree(root: ElementTree.Element) -> None:
    """Let programs show all links of a street red or amber when they do so straight on."""
    links: dict[tuple[str, str], list[tuple[int, int]]] = {}
    for one in root.iter("connection"):
        if light := one.get("tl"):
            place = STRAIGHT_FIRST.find(one.attrib["dir"]) % (len(STRAIGHT_FIRST) + 1)
            own = links.setdefault((light, one.attrib["from"]), [])
            own.append((place, int(one.attrib["linkIndex"])))
    for logic in root.iter("tlLogic"):
        streets = [sorted(own) for (light, _), own in links.items() if light == logic.get("id")]
        for phase in logic.iter("phase"):
            state = list(phase.attrib["state"])
            for (_, first), *others in streets:
                if state[first] not in "Gg":
                    for _, link in others:
                        state[link] = state[first]
            phase.set("state", "".join(state))


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


def crossings(roads: Iterable[tuple[str, str]]) -> set[str]:
    """Return the nodes at which at least three roads meet, of the ends of all edges."""
    beside: dict[str, set[str]] = {}
    for start, end in roads:
        beside.setdefault(start, set()).add(end)
        beside.setdefault(end, set()).add(start)
    return {node for node, others in beside.items() if len(others) >= 3}


def _node_xml(nodes: tuple[RoadNode, ...], lit: Collection[str] = ()) -> str:
    kinds = ["traffic_light" if node.name in lit else "priority" for node in nodes]
    lines = [
        f'<node id={_quoted(node.name)} x="{node.x:.3f}" y="{node.y:.3f}" type="{kind}"/>'
        for node, kind in zip(nodes, kinds, strict=True)
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
