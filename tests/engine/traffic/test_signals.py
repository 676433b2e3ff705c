"""Traffic lights: what is shown is what SUMO shows, and no car passes a red one."""

from xml.etree import ElementTree

import numpy as np
import pytest

from eyas.engine.traffic import network
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.fleet import fleet_of
from eyas.engine.traffic.net_file import SumoNet
from eyas.engine.traffic.network import network_xml
from eyas.engine.traffic.record import WARM_UP, record, resolved
from eyas.engine.traffic.recording_file import from_bytes, to_bytes
from eyas.engine.traffic.signals import Aspect, signal_plan, walk_plan
from eyas.engine.traffic.sumo import RATE, SumoRun

NET = """<net>
<tlLogic id="a" type="static" programID="0" offset="7">
<phase duration="10" state="rGsYr"/><phase duration="3" state="uyOgr"/>
<phase duration="7" state="GroGr"/>
</tlLogic>
<tlLogic id="b" type="actuated" programID="0" offset="0"><phase duration="10" state="r"/></tlLogic>
<connection from="left" to="x" linkIndex="1" tl="a" dir="l"/>
<connection from="left" to="z" linkIndex="4" tl="a" dir="s"/>
<connection from="left" to="y" linkIndex="0" tl="a" dir="s"/>
<connection from="right" to="x" linkIndex="1" tl="a" dir="r"/>
<connection from="dark" to="x" linkIndex="2" tl="a" dir="s"/>
<connection from="yields" to="x" linkIndex="3" tl="a" dir="s"/>
<connection from=":inside_0" to="x" linkIndex="3" tl="a" dir="s"/>
<connection from="clever" to="x" linkIndex="0" tl="b" dir="s"/>
<connection from="free" to="x" dir="s"/>
</net>"""


def test_phases_are_those_of_the_program_for_who_drives_straight_on():
    plan = signal_plan(SumoNet(NET.encode()))
    assert plan.edges == ("left", "right", "dark", "yields", "clever")
    begin = 7.0 - WARM_UP
    time = begin + np.array([0.0, 9.999, 10.0, 12.999, 13.0, 19.999, 20.0, 400.0, -0.001])
    shown = [[Aspect(one).name for one in row] for row in plan.at(time).tolist()]
    first = ["RED", "GREEN", "RED", "AMBER", "AMBER"]
    second = ["RED_AMBER", "AMBER", "DARK", "GREEN", "AMBER"]
    third = ["GREEN", "RED", "AMBER", "GREEN", "AMBER"]
    assert shown == [first, first, second, second, third, third, first, first, third]


def test_a_phase_begins_at_the_physics_step_at_which_the_last_one_ends():
    plan = signal_plan(SumoNet(NET.encode()))
    begin = 7.0 - WARM_UP
    # A nanosecond is less than the error of sums of steps of 2 ms.
    for ends, aspect in ((10.0, Aspect.RED_AMBER), (13.0, Aspect.GREEN), (20.0, Aspect.RED)):
        for off in (-1e-9, 0.0, 1e-9):
            assert plan.at(np.array([begin + ends + off]))[0, 0] == aspect
        assert plan.at(np.array([begin + ends - 0.002]))[0, 0] != aspect


WALKED = """<net>
<edge id=":x_c0" function="crossing" crossingEdges="in out"/>
<edge id=":x_c1" function="crossing" crossingEdges="other"/>
<edge id=":y_c0" function="crossing" crossingEdges="in"/>
<edge id=":z_c0" function="crossing" crossingEdges="in"/>
<tlLogic id="x" type="static" programID="0" offset="5">
<phase duration="10" state="GrrG"/><phase duration="4" state="yrrr"/>
<phase duration="20" state="rGGr"/><phase duration="5" state="rGrr"/>
<phase duration="2" state="uyrr"/>
</tlLogic>
<tlLogic id="y" type="actuated" programID="0" offset="0"><phase duration="9" state="rG"/></tlLogic>
<connection from="in" to="out" linkIndex="0" tl="x" dir="s"/>
<connection from="other" to="out" linkIndex="1" tl="x" dir="r"/>
<connection from=":x_w0" to=":x_c0" linkIndex="2" tl="x" dir="s"/>
<connection from=":x_w1" to=":x_c1" linkIndex="3" tl="x" dir="s"/>
<connection from=":y_w0" to=":y_c0" linkIndex="1" tl="y" dir="s"/>
<connection from=":z_w0" to=":z_c0" dir="s"/>
</net>"""


def test_people_go_while_those_on_the_crossed_street_have_red():
    plan = walk_plan(SumoNet(WALKED.encode()))
    assert plan.edges == (":x_c0", ":x_c1", ":y_c0")
    time = 5.0 - WARM_UP + np.array([5.0, 12.0, 20.0, 36.0, 40.0])
    shown = [[Aspect(one).name for one in row] for row in plan.at(time).tolist()]
    own = ["RED", "RED", "GREEN", "AMBER", "RED"]
    other = ["GREEN", "AMBER", "RED", "RED", "RED"]
    assert [row[:2] for row in shown] == [list(pair) for pair in zip(own, other, strict=True)]
    # What SUMO will do by what drives is not known: nobody is sent to cross.
    assert {row[2] for row in shown} == {"RED"}
    np.testing.assert_array_equal(plan.only(1).at(time)[:, 0], plan.at(time)[:, 1])


@pytest.fixture(scope="module")
def lit(grid):
    """The network of a grid with traffic lights, and its graph."""
    with pytest.MonkeyPatch.context() as patch:
        more = ("--tls.guess", "true", "--tls.guess.threshold", "1")
        patch.setattr(network, "OPTIONS", (*network.OPTIONS, *more))
        return network_xml(grid)


@pytest.mark.sumo
def test_what_is_shown_is_what_sumo_shows_and_nobody_passes_red(lit):
    plan = signal_plan(SumoNet(lit))
    assert len(plan.edges) >= 4
    links = [one for one in ElementTree.fromstring(lit).iter("connection") if one.get("tl")]
    inside = {one.attrib["via"]: (one.attrib["tl"], int(one.attrib["linkIndex"])) for one in links}
    straight = {one.attrib["from"]: inside[one.attrib["via"]] for one in links[::-1]
                if one.get("dir") == "s"}  # fmt: skip
    config, before, passed = resolved(TrafficConfig(max_vehicles=12), 1), {}, []
    run = SumoRun(lit, config, fleet_of(config, 200.0))
    try:
        for step in range(1, 200 * RATE):
            run.advance()
            lights = {k: run.sumo.trafficlight.getRedYellowGreenState(k)
                      for k in run.sumo.trafficlight.getIDList()}  # fmt: skip
            # SUMO tells what held during the step that it has made.
            shown = plan.at(np.array([(step - 0.5) / RATE - WARM_UP]))[0]
            for edge, one in zip(plan.edges, shown.tolist(), strict=True):
                if edge in straight:
                    light, index = straight[edge]
                    assert lights[light][index] in {0: "r", 2: "y", 3: "gG"}[one], (step, edge)
            for vehicle in run.sumo.vehicle.getIDList():
                lane, last = run.sumo.vehicle.getLaneID(vehicle), before.get(vehicle, ":")
                if lane in inside and not last.startswith(":"):
                    light, index = inside[lane]
                    passed.append(lights[light][index])
                before[vehicle] = lane
    finally:
        run.close()
    assert len(passed) > 30
    assert "r" not in passed


@pytest.mark.sumo
def test_working_signals_change_neither_lanes_nor_corners(grid):
    plain, lit = (SumoNet(network_xml(grid, signals=on)) for on in (False, True))
    streets = [[e for e in net.edges if e.function is None] for net in (plain, lit)]
    assert streets[0] == streets[1]
    for node in grid.nodes:
        assert plain.junctions[node.name] == lit.junctions[node.name]
    assert not plain.programs
    assert len(lit.programs) == 12  # not at the four corners of the grid, which are bends


@pytest.mark.sumo
def test_all_of_a_street_stop_at_its_one_light(grid):
    net = SumoNet(network_xml(grid, signals=True))
    states = {one.name: np.array([list(phase.state) for phase in one.phases]).T
              for one in net.programs}  # fmt: skip
    links: dict[tuple[str, str], list[int]] = {}
    for one in net.connections:
        if one.light:
            links.setdefault((one.light, one.start), []).append(one.link)
    for (light, _), own in links.items():
        red = states[light][own] == "r"
        assert (red == red[0]).all()
        assert red.any()


@pytest.mark.sumo
def test_nobody_passes_a_red_light_in_a_recording(grid):
    config = TrafficConfig(max_vehicles=20, signals="working")
    recording = record("grid", 0, grid, config, 120.0, 1)
    assert recording.provenance.config.signals == "working"
    assert from_bytes(to_bytes(recording), "memory").provenance == recording.provenance
    net = SumoNet(network_xml(grid, signals=True))
    plan, ends = signal_plan(net), {one.name: one.lanes[0].points[-2:] for one in net.edges}
    shown = plan.at(np.arange(len(recording.present)) / recording.rate)
    ahead = np.stack([np.cos(recording.yaw), np.sin(recording.yaw)], axis=-1)
    front, passed = recording.position + 2.5 * ahead, []
    for row, edge in enumerate(plan.edges):
        start, end = ends[edge]
        onwards = (end - start) / np.linalg.norm(end - start)
        over = (front - end) @ onwards
        near = np.linalg.norm(front - end, axis=-1) < 6.0
        along = ahead @ onwards > 0.95
        crosses = (over[:-1] < 0.0) & (over[1:] >= 0.0) & near[1:] & along[1:]
        passed += shown[1:, row][np.nonzero(crosses)[0]].tolist()
    assert len(passed) > 60
    assert Aspect.RED not in passed
