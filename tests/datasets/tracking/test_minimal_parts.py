"""Parts of one's own that derive from ours and leave out all that may be left out, or more."""

from pathlib import Path

import pytest

import eyas
from eyas.benchmark.policies.box_trackers import BoxTracker, box_tracker
from eyas.benchmark.policies.own_policy import load_callable
from eyas.engine.core.errors import ConfigError
from eyas.engine.custom.own import OwnTarget
from eyas.engine.custom.user_class import made
from eyas.engine.exports.registry import chosen_writers
from eyas.engine.recordings.export import _format_of
from eyas.engine.recordings.format import ExportJob
from eyas.engine.sim.flights.path import CameraPath
from eyas.engine.sim.flights.registry import path_named


class BareFormat(eyas.Format):
    needs = frozenset({"jpeg"})


class SmallFormat(BareFormat):
    def add(self, episode):
        (self.job.folder / episode.name).touch()


class BareWriter(eyas.Writer):
    files = eyas.Files(frame=("x",))


class BareTracker(BoxTracker):
    pass


class BarePolicy(eyas.Policy):
    pass


class BarePath(CameraPath):
    pass


class SmallPath(CameraPath):
    def sketch(self, scene, rng):
        raise NotImplementedError


class BareTarget(OwnTarget):
    pass


@pytest.mark.parametrize(
    ("load", "name", "line"),
    [
        (_format_of, "BareFormat", "is not a format: it has no 'add'"),
        (lambda name: chosen_writers([name]), "BareWriter", "is not a writer: it has no 'begin'"),
        (box_tracker, "BareTracker", r"a class with begin\(picture, box\) and update"),
        (lambda name: load_callable(name, {}), "BareTracker", "a class with begin"),
        (lambda name: load_callable(name, {}), "BarePolicy", r"a class with act\(observation\)"),
        (path_named, "BarePath", "is not a camera path: it has no 'sketch'"),
        (made, "BareTarget", r"it has not all of: size, parts\(\), pose\(ride\)"),
    ],
)
def test_a_part_that_leaves_out_too_much_is_refused_when_it_is_named(load, name, line):
    with pytest.raises(ConfigError, match=f"{name}.*{line}"):
        load(f"{__name__}:{name}")


def test_a_format_needs_no_init_and_a_path_no_attributes(tmp_path: Path):
    job = ExportJob(tmp_path, "x", copies=False, least_side=0, least_visible=0.0)
    form = _format_of(f"{__name__}:SmallFormat")(job)
    assert form.job is job
    form.finish([])
    path = path_named(f"{__name__}:SmallPath")
    assert (path.in_view, path.searches) == (1.0, False)
