"""The traffic of an episode as OpenSCENARIO XML."""

import math
import os
import shutil
import subprocess
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from eyas.engine.exports.writer import Summary
from eyas.engine.sim.scenes import load_network
from eyas.maps.formats.openscenario import ScenarioWriter

FRAMES = 5

pytestmark = pytest.mark.sumo  # whose netconvert writes the roads


@pytest.fixture
def written(run, episode, frame):
    """The file of five frames."""

    def write(frames=FRAMES):
        part = ScenarioWriter(run).begin(episode)
        for number in range(frames):
            part.add(frame(number))
        part.finish()
        return episode.folder / "traffic.xosc"

    return write


def place(position):
    world = position.find("WorldPosition")
    return [float(world.attrib[key]) for key in "xyzhp"]


def events(root, name):
    """Each event of an entity: its action, and the time at which it starts [s]."""
    (group,) = (each for each in root.iter("ManeuverGroup") if each.get("name") == name)
    assert [each.get("entityRef") for each in group.iter("EntityRef")] == [name]
    return [
        (event.find("Action")[0], float(event.find(".//SimulationTimeCondition").get("value")))
        for event in group.iter("Event")
    ]


def test_everything_that_moves_follows_its_way_in_its_time(written):
    root = ElementTree.parse(written()).getroot()
    head = root.find("FileHeader")
    assert (head.get("revMajor"), head.get("revMinor")) == ("1", "2")
    names = [each.get("name") for each in root.iter("ScenarioObject")]
    assert names == ["DRONE0", "car-65536", "bus-65537", "person-65538"]
    ((action, start),) = events(root, "car-65536")
    assert start == 0.0
    vertices = action.findall(".//Vertex")
    assert [float(each.get("time")) for each in vertices] == pytest.approx(
        [0, 0.04, 0.08, 0.12, 0.16]
    )
    for number, vertex in enumerate(vertices):
        # Its nose is up, and the pitch of OpenSCENARIO is positive down.
        assert place(vertex.find("Position")) == [14.0 + 0.5 * number, 2.0, 0.0, 0.0, -0.125]
    ((action, _),) = events(root, "DRONE0")
    assert place(action.find(".//Position")) == [1.0, 2.0, 22.0, 0.0, 0.0]


def test_what_comes_and_goes_is_added_and_deleted(written):
    root = ElementTree.parse(written()).getroot()
    begun = [each.get("entityRef") for each in root.find("Storyboard/Init").iter("Private")]
    assert begun == ["DRONE0", "car-65536", "person-65538"]
    came, moved, went = events(root, "bus-65537")
    assert came[0].find(".//AddEntityAction") is not None
    assert came[1] == moved[1] == pytest.approx(0.04)
    assert len(moved[0].findall(".//Vertex")) == 2
    assert went[0].find(".//DeleteEntityAction") is not None
    assert went[1] == pytest.approx(0.08)
    end = root.find("Storyboard/StopTrigger").find(".//SimulationTimeCondition")
    assert float(end.get("value")) == pytest.approx(0.16)


def test_boxes_are_those_of_the_models(written):
    root = ElementTree.parse(written()).getroot()
    made = {each.get("name"): each[0] for each in root.iter("ScenarioObject")}
    kinds = [(each.tag, each.get("vehicleCategory")) for each in made.values()]
    assert kinds == [
        ("MiscObject", None), ("Vehicle", "car"), ("Vehicle", "bus"), ("Pedestrian", None),
    ]  # fmt: skip
    box = made["car-65536"].find("BoundingBox")
    sides = [float(box.find("Dimensions").get(side)) for side in ("length", "width", "height")]
    assert sides == [4.85, 1.9, 1.8]
    assert [float(box.find("Center").get(axis)) for axis in "xyz"] == [-1.0, 0.0, 0.9]


def test_a_scenario_tells_how_many_frames_it_has(written, run, episode):
    assert ScenarioWriter(run).read(episode.folder) is None
    path = written()
    assert ScenarioWriter(run).read(episode.folder) == Summary(FRAMES)
    path.write_bytes(path.read_bytes()[:-9])
    assert ScenarioWriter(run).read(episode.folder) is None
    written(1)
    assert ScenarioWriter(run).read(episode.folder) == Summary(1)
    root = ElementTree.parse(path).getroot()
    assert all(events(root, each.get("name")) for each in root.iter("ManeuverGroup"))


def test_roads_lie_where_the_traffic_drives(run, tmp_path):
    world = run.config.world.model_copy(update={"map": "farmland-bare"})
    run = replace(run, config=run.config.model_copy(update={"world": world}))
    ScenarioWriter(run).finish(())
    root = ElementTree.parse(tmp_path / "roads.xodr").getroot()
    network = load_network("farmland-bare", 0)
    points = []
    for part in root.iter("geometry"):
        x, y, heading = (float(part.attrib[key]) for key in ("x", "y", "hdg"))
        points += [
            [x + along * math.cos(heading), y + along * math.sin(heading)]
            for along in np.arange(0.0, float(part.attrib["length"]), 2.0)
        ]
    road = np.array(points)
    for point in network.lane_points[::7]:
        assert np.sqrt(np.square(road - point).sum(axis=1).min()) < 20.0  # four lanes of 4 m


@pytest.mark.checker
def test_asams_checker_finds_no_issue(written, tmp_path):
    checker = shutil.which("qc_openscenario")
    if checker is None:
        pytest.skip("there is no asam-qc-openscenarioxml")
    for frames in (FRAMES, 1):
        result, config = tmp_path / "result.xqar", tmp_path / "config.xml"
        bundle = f'<Param name="resultFile" value="{result}"/>'
        config.write_text(
            f'<Config><Param name="InputFile" value="{written(frames)}"/>'
            f'<CheckerBundle application="xoscBundle">{bundle}</CheckerBundle></Config>'
        )
        # The checker brings its own libraries.
        own = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        subprocess.run([checker, "-c", config], check=True, capture_output=True, env=own)
        report = ElementTree.parse(result).getroot()
        done = {check.get("checkerId"): check.get("status") for check in report.iter("Checker")}
        known = [status for status in done.values() if status == "completed"]
        assert len(known) >= 10
        assert set(done.values()) <= {"completed", "skipped"}
        assert not list(report.iter("Issue"))
