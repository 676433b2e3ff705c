"""The site builds without a warning, and asks nothing of the network."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LOADED = re.compile(r'<(?:script|link|img|video|iframe)\b[^>]*?\b(?:src|href)="([^"]+)"')

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    pytest.importorskip("furo", reason="extra docs")
    folder = tmp_path_factory.mktemp("site")
    command = (sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", ROOT / "docs", folder)
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return folder


def test_every_page_has_all_that_it_shows_and_loads_nothing_from_elsewhere(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) > 80
    for page in pages:
        for address in LOADED.findall(page.read_text()):
            assert "://" not in address, (page, address)
            if not address.startswith(("#", "data:", "mailto:")):
                file = address.partition("#")[0].partition("?")[0]
                assert (page.parent / file).exists(), (page, address)


def test_references_are_made_from_the_code(site):
    def text(name):
        return (site / "reference" / name).read_text()

    assert 'id="eyas.PolicyInput.snapshot"' in text("api/policies-and-trackers.html")
    assert "--episode" in text("commands.html")
    assert "tracker.wind.speed" in text("settings.html")


def test_the_search_finds_a_setting(site):
    assert "motor_time_constant" in (site / "searchindex.js").read_text()
