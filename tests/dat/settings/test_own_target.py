"""Names of one's own targets in the original's `Tracking_Object`."""

import json

import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.settings.file import load_settings

PROTO = """#VRML_SIM R2023b utf8
PROTO Fox [ field SFVec3f translation 0 0 0 ] {
  Solid { translation IS translation children [ Shape { geometry Box { size 1 0.4 0.5 } } ] }
}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The original's folder of settings, beside that of its PROTOs."""
    monkeypatch.chdir(tmp_path)
    for name in ("config", "protos"):
        (tmp_path / "traffic_project" / name).mkdir(parents=True)
    return tmp_path / "traffic_project"


def settings(folder, **values):
    path = folder / "config" / "env_config.json"
    path.write_text(json.dumps({"Tracker_Def": "DRONE", **values}))
    return path


def test_a_name_is_that_of_a_proto_where_the_manual_wants_it(folder):
    (folder / "protos" / "Fox.proto").write_text(PROTO)
    custom = load_settings(settings(folder, Tracking_Object="Fox")).custom
    assert custom.mesh == str(folder / "protos" / "Fox.proto")
    assert custom.trajectory is None
    again = load_settings(settings(folder), ["Tracking_Object=Fox"]).custom
    assert again.mesh == custom.mesh


def test_a_trajectory_of_the_same_name_moves_it(folder):
    (folder / "config" / "Fox.csv").write_text("t,x,y\n0,0,0\n60,50,0\n")
    only = load_settings(settings(folder, Tracking_Object="Fox")).custom
    assert (only.mesh, only.trajectory) == (None, str(folder / "config" / "Fox.csv"))
    (folder / "config" / "Fox.obj").write_text("v 0 0 0\n")
    both = load_settings(settings(folder, Tracking_Object="Fox")).custom
    assert (both.mesh, both.trajectory) == (str(folder / "config" / "Fox.obj"), only.trajectory)


def test_a_name_is_that_of_the_settings_beside_it(folder):
    path = settings(folder, Tracking_Object="Fox", custom={"behaviour": "wander", "speed": 2.5})
    config = load_settings(path)
    assert config.custom.speed == 2.5
    assert config.original is not None
    few = folder / "config" / "few.json"
    few.write_text(json.dumps({"Tracking_Object": "Fox", "custom": {"behaviour": "wander"}}))
    assert load_settings(few).custom.behaviour == "wander"
    with pytest.raises(EyasError, match=r"custom\.sped: unknown key"):
        load_settings(settings(folder, Tracking_Object="Fox", custom={"sped": 2.5}))


@pytest.mark.parametrize(
    "name", ["MyProto", "a" * 5000, "../protos/Fox", "os:abort", "Fox/..", "a\x00b"]
)
def test_a_name_of_nothing_is_refused_with_the_ways_there_are(folder, name):
    (folder / "protos" / "Fox.proto").write_text(PROTO)
    with pytest.raises(EyasError, match=r"^Tracking_Object: ") as caught:
        load_settings(settings(folder, Tracking_Object=name))
    line = str(caught.value)
    assert 'settings "custom" beside it, or a file of that name (' in line
    assert ".proto" in line
    assert str(folder / "config/../protos").replace("config/../", "") in line
    assert "\n" not in line


def test_whole_numbers_may_be_written_as_the_original_reads_them(folder):
    config = load_settings(settings(folder, Train_Total_Steps=1500.0, Init_No_Done_Steps=50.0))
    assert (config.done.total_steps, config.done.grace_steps) == (1500, 50)
    with pytest.raises(EyasError, match=r"^Train_Total_Steps: 1500\.5 is not allowed"):
        load_settings(settings(folder, Train_Total_Steps=1500.5))


def test_what_a_crash_is_has_a_key_of_ours(folder):
    assert load_settings(settings(folder)).done.crash == "original"
    assert load_settings(settings(folder, Done_Range={"crash": "end"})).done.crash == "end"
    with pytest.raises(EyasError, match=r"^Done_Range\.crash: 'ned' is not allowed; did you mean"):
        load_settings(settings(folder, Done_Range={"crash": "ned"}))
