"""Protocols and policies of users and of installed packages: found, flown, told in results."""

import json
import re
import shutil
import sys
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import eyas
from eyas.benchmark.plan.entry import entry_class
from eyas.benchmark.plan.plan import EvaluationPlan, opened
from eyas.benchmark.policies.box_trackers import BOX_TRACKERS
from eyas.benchmark.policies.table import (
    ABOUT,
    ORACLES,
    POLICIES,
    open_policy,
    policy_names,
    runs_code,
)
from eyas.benchmark.protocols.flown import FLOWN
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.protocols.table import PROTOCOLS, protocol_named
from eyas.benchmark.records.result import load_run
from eyas.benchmark.report.leaderboard import page
from eyas.benchmark.report.leaderboard.submission import complete_run
from eyas.benchmark.statistics.comparison import refuse_incomparable
from eyas.cli.app import app
from eyas.engine.core.errors import ConfigError, DataFileError, EyasError, UnknownNameError
from eyas.engine.core.named_code import origin_of
from eyas.engine.policies.policy import Instruction, PolicyInput, Start
from eyas.engine.targets.grammar.attributes import ATTRIBUTES

HERE = Path(__file__).parent
TABLES = {"eyas.protocols": PROTOCOLS, "eyas.policies": POLICIES}


@pytest.fixture
def town(tmp_path, monkeypatch):
    """An installed package that adds a protocol and a policy."""
    folder = tmp_path / "site"
    (folder / "town").mkdir(parents=True)
    (folder / "town" / "__init__.py").write_text("")
    shutil.copy(HERE / "own_protocols.py", folder / "town" / "rules.py")
    (folder / "town" / "minds.py").write_text("def down(picture):\n    return 6\n")
    info = folder / "town-1.5.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: town\nVersion: 1.5\n")
    (info / "top_level.txt").write_text("town\n")
    (info / "entry_points.txt").write_text(
        "[eyas.protocols]\nquick = town.rules:QUICK\n[eyas.policies]\ndown = town.minds:down\n"
    )
    monkeypatch.syspath_prepend(folder)
    for group, table in TABLES.items():
        monkeypatch.setattr(table, "_points", entry_points(group=group))
        monkeypatch.setattr(table, "_loaded", {})
    yield folder
    for name in [name for name in sys.modules if name.split(".")[0] == "town"]:
        del sys.modules[name]


@pytest.mark.parametrize("name", PROTOCOLS.built_in)
def test_each_protocol_of_the_table_has_the_name_under_which_it_is_found(name):
    protocol = protocol_named(name)
    assert isinstance(protocol, Protocol)
    assert protocol.name == name


# The networks of `nano` may not be given away, so they are not here.
@pytest.mark.parametrize("name", [name for name in POLICIES.built_in if name != "nano"])
def test_each_policy_of_the_table_can_be_opened_and_has_the_class_of_its_kind(name):
    if name in BOX_TRACKERS or name.endswith("-servo"):
        pytest.importorskip("cv2")
    expected = {
        **dict.fromkeys(ORACLES, "privileged"),
        **dict.fromkeys(BOX_TRACKERS, "box"),
        **dict.fromkeys(("attribute-servo",), "text+pixels"),
    }
    assert entry_class(open_policy(name, {})) == expected.get(name, "pixels")


def test_a_variant_says_only_what_differs():
    from own_protocols import CALM

    assert CALM.settings.tracker.wind.speed == 2.0
    assert CALM.settings.tracker.wind.direction == FLOWN.settings.tracker.wind.direction
    assert CALM.settings.control == FLOWN.settings.control
    assert (CALM.variants, CALM.choose, CALM.episodes) == (FLOWN.variants, FLOWN.choose, 1)
    assert CALM.hash != FLOWN.hash
    assert FLOWN.like("other", "the same").hash == FLOWN.hash, "names are no part of it"


def test_names_of_installed_packages_are_known(town):
    assert "quick" in eyas.list_protocols()
    assert "down" in policy_names()
    assert "down" in eyas.list_policies()
    said = CliRunner().invoke(app, ["policies", "list"]).output
    assert re.search(r"^down +town\.minds:down$", said, re.MULTILINE)
    assert re.search(r"^hover +does nothing", said, re.MULTILINE)
    assert {*ABOUT} == {*POLICIES.built_in}
    with pytest.raises(UnknownNameError, match=r"^train\.x: 'quikc'.*'quick'"):
        protocol_named("quikc", "train.x")


def test_code_of_a_package_flies_apart_under_its_name(town):
    plan = EvaluationPlan(policy="down", protocol="quick")
    assert runs_code("down")
    assert not runs_code("hover")
    _, entry = opened(plan)
    assert (entry.apart, entry.entry_class) == (True, "pixels")


def page_of(folder):
    page.run(folder, folder / "index.html")
    return (folder / "index.html").read_text()


@pytest.mark.slow
def test_figures_of_an_outside_protocol_tell_whose_it_is(town, tmp_path):
    out = tmp_path / "run"
    records = eyas.evaluate("down", "quick", out)
    assert len(records) == 4
    result = json.loads((out / "result.json").read_text())
    told = result["rules"]
    assert told["path"] == "town.rules:QUICK"
    assert (told["package"], told["version"], len(told["code"])) == ("town", "1.5", 12)
    eyas.evaluate("down", "quick", out, resume=True)
    _, _, again = complete_run(out)
    assert again == records
    assert f"</code> of town 1.5 {told['code']}, Eyas" in page_of(out)
    with (town / "town" / "rules.py").open("a") as file:
        file.write("\n")  # another code, with the same hash of the protocol
    with pytest.raises(EyasError, match="its rules was"):
        eyas.evaluate("down", "quick", out, resume=True)
    eyas.evaluate("down", "quick", tmp_path / "other")
    (one, _), (other, _) = load_run(out), load_run(tmp_path / "other")
    with pytest.raises(DataFileError, match=r"code differs: town 1\.5 \w+ and town 1\.5 \w+$"):
        refuse_incomparable(one, other, across_builds=False)


def test_the_code_of_a_module_alone_is_told_too():
    origin = origin_of("own_protocols:CALM")
    assert (origin.package, origin.version) == (None, None)
    assert origin.code == origin_of("own_protocols:OTHER").code
    assert origin.code != origin_of("own_policies:Batch").code


def test_a_path_that_results_name_is_not_imported_unasked(tmp_path, monkeypatch):
    (tmp_path / "evil.py").write_text("raise BaseException('it was imported')")
    monkeypatch.syspath_prepend(tmp_path)
    plan = {"policy": "hover", "protocol": "evil:P"}
    (tmp_path / "run.json").write_text(json.dumps({"plan": plan}))
    with pytest.raises(DataFileError, match=r"'evil:P' is code: --trust runs it"):
        load_run(tmp_path)
    result = CliRunner().invoke(app, ["compare", str(tmp_path), str(tmp_path)])
    assert "--trust" in str(result.exception)


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ("paperr", "'paperr' is not allowed; did you mean 'paper'"),
        ("math:pi", "is a float, not a Protocol"),
        ("nowhere_at_all:X", "there is no module"),
    ],
)
def test_what_is_no_protocol_is_told_in_one_line(said, why):
    with pytest.raises(ConfigError, match=why) as caught:
        EvaluationPlan(policy="hover", protocol=said)
    assert "\n" not in str(caught.value)


def test_a_batch_policy_is_found_by_its_type_and_knows_no_more():
    policy = open_policy("own_policies:Batch", {"action_repeat": 50})
    assert (policy.env.action_repeat, policy.env.observation.width) == (50, 32)
    assert policy.sampled is False, "no seeds for it"
    _, entry = opened(EvaluationPlan(policy="own_policies:Batch"))
    assert (entry.apart, entry.entry_class) == (True, "box")


def test_a_batch_policy_is_told_what_it_asks_for_and_no_seeds_or_words():
    """The policy itself asserts that there are none."""
    policy, _ = opened(EvaluationPlan(policy="own_policies:Batch"))
    told = Instruction(("the red car",), np.zeros((1, len(ATTRIBUTES))))
    policy.begin(Start(np.array([7]), lambda: np.array([[1, 2, 3, 4]], np.int32), told))
    seen = np.zeros((1, 24, 32, 3), np.uint8)
    sight = PolicyInput(seen, np.ones(1, np.bool_), None, None, np.zeros(1, np.bool_))
    assert policy.act(sight).actions.tolist() == [10 % 7]


@pytest.mark.slow
def test_a_batch_policy_flies_as_one_for_each_episode(fly):
    one, many = fly("own_policies:OneOf"), fly("own_policies:Batch")
    assert all(record.error is None for record in many), many[0].error
    assert [record.cr for record in one] == [record.cr for record in many]
