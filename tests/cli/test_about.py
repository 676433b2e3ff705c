"""`eyas about` says under which licences Eyas and what it needs are."""

import json
import re
import tomllib
from pathlib import Path

from typer.testing import CliRunner

from eyas.cli.app import app
from eyas.cli.tools import parts

ROOT = Path(__file__).parents[2]


def test_every_package_that_eyas_needs_has_a_licence():
    told = {part.name: part.licence for part in parts()}
    asked = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    assert {re.match(r"[\w-]+", line)[0] for line in asked} <= set(told)
    assert "not told" not in told.values()


def test_what_a_wheel_has_within_is_said():
    done = CliRunner().invoke(app, ["about", "--licences"])
    assert done.exit_code == 0
    assert re.search(r"^shapely .*\n  .*GEOS.*LGPL", done.output, re.MULTILINE)


def test_the_page_of_licences_names_the_same_packages():
    page = (ROOT / "docs/licences.md").read_text()
    assert [part.name for part in parts() if part.name not in page] == []


def test_the_list_is_printed_as_json():
    done = CliRunner().invoke(app, ["about", "--json"])
    assert {part["name"] for part in json.loads(done.output)} == {part.name for part in parts()}
