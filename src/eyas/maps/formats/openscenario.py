"""The traffic of an episode as ASAM OpenSCENARIO XML 1.2, on the roads as OpenDRIVE.

Elements and their order are those of the schema, https://www.asam.net/standards/detail/openscenario-xml.
"""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited, write_atomic
from eyas.engine.exports.frame import Frame, RecordedBody
from eyas.engine.exports.writer import EndedEpisode, Episode, Files, Gather, Run, Summary, Writer
from eyas.engine.state.motion import ActorView
from eyas.engine.state.scene import ACTOR_OBJECT, ObjectClass
from eyas.engine.targets.catalogue import MODELS, kind_of
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.sumo_install import sumo_binary
from eyas.engine.world.maps import MAPS
from eyas.lanes import exact
from eyas.maps.formats.roads import opendrive_xml

NAME, ROADS = "traffic.xosc", "roads.xodr"
_END = b"</OpenSCENARIO>\n"
_VEHICLES = {
    ObjectClass.CAR: "car",
    ObjectClass.TRUCK: "truck",
    ObjectClass.BUS: "bus",
    ObjectClass.MOTORCYCLE: "motorbike",
    ObjectClass.BICYCLE: "bicycle",
}
_DRONE = (0.806, 0.806, 0.366)  # Length, width and height of a tracker [m]


class _Moment(NamedTuple):
    """What a frame tells."""

    time: float  # Since the reset [s]
    tracker: RecordedBody
    traffic: ActorView


class _Place(NamedTuple):
    """Where something is at a time."""

    time: float  # Since the first frame [s]
    x: float
    y: float
    z: float
    yaw: float
    pitch: float  # Positive down, as OpenSCENARIO has it [rad]


class _Entity(NamedTuple):
    """Something that moves, and when it is there."""

    name: str
    model: str
    kind: ObjectClass
    size: tuple[float, float, float]
    ahead: float  # Distance of its middle ahead of its reference point [m]
    bottom: float  # z of its lowest point less that of its reference point [m]
    mass: float
    stays: tuple[tuple[_Place, ...], ...]  # Stretches of frames in which it is there


class ScenarioWriter(Writer):
    """`traffic.xosc`: the ways of all that moves, and `roads.xodr` for all episodes.

    Raises:
        MissingExtraError: SUMO, whose netconvert writes the roads, is not installed.
    """

    wants = frozenset({"traffic"})
    files = Files(episode=(NAME,), run=(ROADS,))

    def __init__(self, run: Run) -> None:
        self._run = run
        sumo_binary("netconvert")  # before anything is recorded

    def begin(self, episode: Episode) -> Gather[_Moment]:
        """Return the writer of an episode's scenario."""
        name = episode.tracker
        return Gather(episode.folder / NAME, _moment, lambda moments: _encoded(name, moments))

    def read(self, folder: Path) -> Summary | None:
        """Return the number of frames that the file states."""
        try:
            text = read_limited(folder / NAME, 1 << 30)
        except DataFileError:
            return None
        told = re.search(rb'description="(\d+) frames', text[:400])
        return Summary(int(told[1])) if told and text.endswith(_END) else None

    def finish(self, episodes: Sequence[EndedEpisode]) -> None:
        """Write the roads."""
        world = self._run.config.world
        recipe = MAPS.get(world.map)
        network = network_xml(recipe.roads(world.seed), signals=True)
        write_atomic(self._run.folder / ROADS, opendrive_xml(recipe.name, network))


def _moment(frame: Frame) -> _Moment:
    assert frame.traffic is not None  # as it is wanted
    return _Moment(frame.episode_time, frame.tracker, frame.traffic)


def _entities(tracker: str, moments: Sequence[_Moment]) -> Iterator[_Entity]:
    """Yield the tracker, then all actors that are there in any frame."""
    start = moments[0].time
    ways = []
    for each in moments:
        w, x, y, z = each.tracker.orientation.tolist()
        yaw = float(exact.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))
        east, north, up = each.tracker.position.tolist()
        ways.append(_Place(each.time - start, east, north, up, yaw, 0.0))
    low = -0.5 * _DRONE[2]
    yield _Entity(tracker, "Drone", ObjectClass.ROBOT, _DRONE, 0.0, low, 3.0, (tuple(ways),))
    there = np.array([each.traffic.state.present[0] for each in moments])
    for actor in np.flatnonzero(there.any(axis=0)).tolist():
        yield _actor(actor, moments, there[:, actor].tolist(), start)


def _actor(actor: int, moments: Sequence[_Moment], there: Sequence[bool], start: float) -> _Entity:
    number = int(moments[0].traffic.model[actor])
    model, kind = MODELS[number], kind_of(number)
    leans = 0.0 if kind.object_class is ObjectClass.PERSON else -1.0
    stays: list[list[_Place]] = []
    for each, here, before in zip(moments, there, [False, *there[:-1]], strict=True):
        if not here:
            continue
        if not before:
            stays.append([])
        state = each.traffic.state
        x, y, z = state.position[0, actor].tolist()
        yaw, slope = float(state.yaw[0, actor]), float(state.slope[0, actor])
        stays[-1].append(_Place(each.time - start, x, y, z, yaw, leans * slope + 0.0))
    name = f"{kind.object_class.name.lower()}-{ACTOR_OBJECT + actor}"
    return _Entity(
        name, model.name, kind.object_class, model.size, kind.ahead, 0.0,
        model.mass or 1.0, tuple(map(tuple, stays)),
    )  # fmt: skip


def _encoded(tracker: str, moments: Sequence[_Moment]) -> bytes:
    entities = list(_entities(tracker, moments))
    end = moments[-1].time - moments[0].time
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<OpenSCENARIO>",
        '<FileHeader revMajor="1" revMinor="2" date="1970-01-01T00:00:00" author="Eyas" '
        f'description="{len(moments)} frames, {_number(end)} s"/>',
        "<CatalogLocations/>",
        f'<RoadNetwork><LogicFile filepath="../../{ROADS}"/></RoadNetwork>',
        "<Entities>",
        *map(_object, entities),
        "</Entities>",
        "<Storyboard>",
        "<Init><Actions>",
        *(_start(entity) for entity in entities if entity.stays[0][0].time == 0.0),
        "</Actions></Init>",
        '<Story name="traffic"><Act name="traffic">',
        *(line for entity in entities for line in _manoeuvres(entity, end)),
        _when("act", "StartTrigger", 0.0),
        "</Act></Story>",
        _when("end", "StopTrigger", end),
        "</Storyboard>",
    ]
    return "\n".join([*lines, ""]).encode() + _END


def _object(entity: _Entity) -> str:
    """Return an entity with its box, whose middle is told from its reference point."""
    length, width, height = map(_number, entity.size)
    middle = _number(entity.bottom + 0.5 * entity.size[2])
    box = (
        f'<BoundingBox><Center x="{_number(entity.ahead)}" y="0" z="{middle}"/>'
        f'<Dimensions width="{width}" length="{length}" height="{height}"/></BoundingBox>'
    )
    model, mass = quoteattr(entity.model), f'mass="{_number(entity.mass)}"'
    if entity.kind in _VEHICLES:
        inside = (
            f'<Vehicle name={model} vehicleCategory="{_VEHICLES[entity.kind]}" {mass}>{box}'
            '<Performance maxSpeed="70" maxAcceleration="30" maxDeceleration="30"/>'
            f"{_axles(entity)}<Properties/></Vehicle>"
        )
    elif entity.kind is ObjectClass.PERSON:
        inside = (
            f'<Pedestrian name={model} pedestrianCategory="pedestrian" {mass}>{box}'
            "<Properties/></Pedestrian>"
        )
    else:
        inside = (
            f'<MiscObject name={model} miscObjectCategory="none" {mass}>{box}'
            "<Properties/></MiscObject>"
        )
    return f'<ScenarioObject name="{entity.name}">{inside}</ScenarioObject>'


def _axles(entity: _Entity) -> str:
    """Return two axles, where those of a usual vehicle of its size are."""
    length, width, _ = entity.size
    common = f'wheelDiameter="0.7" trackWidth="{_number(0.85 * width)}" positionZ="0.35"'
    front, rear = (entity.ahead + share * length for share in (0.3, -0.3))
    return (
        f'<Axles><FrontAxle maxSteering="0.6" positionX="{_number(front)}" {common}/>'
        f'<RearAxle maxSteering="0" positionX="{_number(rear)}" {common}/></Axles>'
    )


def _start(entity: _Entity) -> str:
    place = _position(entity.stays[0][0])
    action = f"<PrivateAction><TeleportAction>{place}</TeleportAction></PrivateAction>"
    return f'<Private entityRef="{entity.name}">{action}</Private>'


def _manoeuvres(entity: _Entity, end: float) -> Iterator[str]:
    """Yield what an entity does: it comes, follows its way, and goes."""
    name = entity.name
    yield (
        f'<ManeuverGroup name="{name}" maximumExecutionCount="1"><Actors '
        f'selectTriggeringEntities="false"><EntityRef entityRef="{name}"/></Actors>'
        f'<Maneuver name="{name}">'
    )
    for number, stay in enumerate(entity.stays):
        first, last = stay[0].time, stay[-1].time
        label = f"{name}-{number}"
        if first > 0.0:
            added = f"<AddEntityAction>{_position(stay[0])}</AddEntityAction>"
            yield _event(f"{label}-comes", _of_entity(name, added), first)
        if len(stay) > 1 or end == 0.0:  # an episode of one frame does something, too
            way = stay if len(stay) > 1 else stay * 2
            yield _event(f"{label}-moves", _along(label, way), first)
        if last < end:
            yield _event(f"{label}-goes", _of_entity(name, "<DeleteEntityAction/>"), last)
    yield "</Maneuver></ManeuverGroup>"


def _of_entity(name: str, action: str) -> str:
    return f'<GlobalAction><EntityAction entityRef="{name}">{action}</EntityAction></GlobalAction>'


def _along(label: str, stay: Sequence[_Place]) -> str:
    vertices = "\n".join(
        f'<Vertex time="{_number(place.time)}">{_position(place)}</Vertex>' for place in stay
    )
    return (
        "<PrivateAction><RoutingAction><FollowTrajectoryAction><TimeReference><Timing "
        'domainAbsoluteRelative="absolute" offset="0" scale="1"/></TimeReference>'
        '<TrajectoryFollowingMode followingMode="position"/><TrajectoryRef>'
        f'<Trajectory name="{label}" closed="false"><Shape><Polyline>\n{vertices}\n</Polyline>'
        "</Shape></Trajectory></TrajectoryRef></FollowTrajectoryAction></RoutingAction>"
        "</PrivateAction>"
    )


def _event(name: str, action: str, time: float) -> str:
    return (
        f'<Event name="{name}" priority="parallel" maximumExecutionCount="1">'
        f'<Action name="{name}">{action}</Action>{_when(name, "StartTrigger", time)}</Event>'
    )


def _when(name: str, trigger: str, time: float) -> str:
    return (
        f'<{trigger}><ConditionGroup><Condition name="{name}" delay="0" conditionEdge="none">'
        f'<ByValueCondition><SimulationTimeCondition value="{_number(time)}" '
        'rule="greaterOrEqual"/></ByValueCondition></Condition></ConditionGroup>'
        f"</{trigger}>"
    )


def _position(place: _Place) -> str:
    x, y, z, h, p = (_number(part) for part in place[1:])
    return f'<Position><WorldPosition x="{x}" y="{y}" z="{z}" h="{h}" p="{p}" r="0"/></Position>'


def _number(value: float) -> str:
    return repr(round(value, 4) + 0.0).removesuffix(".0")
