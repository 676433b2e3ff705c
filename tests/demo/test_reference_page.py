"""The page of recorded flights in a real Chromium; collected where one is installed."""

import pytest

from eyas.benchmark.policies.person import read_log

from .conftest import until

pytestmark = pytest.mark.slow  # flights are in real time

GRASS = ["--record-for", "paper", "--map", "simpleway-grass", "--episodes", "1"]


def test_a_person_begins_a_flight_flies_it_by_keys_and_leaves_the_next(serve, browser):
    served = serve(*GRASS, "--out", "people", quick=[])
    page = browser.new_context(viewport={"width": 800, "height": 600}).new_page()
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda line: problems.append(line.text) if line.type == "error" else None)
    page.goto(served.address)
    for number in (1, 2):
        ready = f"document.getElementById('line').textContent.startsWith('Flight {number} of 4,')"
        until(page, ready, seconds=120)
        page.fill("#pilot", "Ann")
        page.keyboard.press("Enter")
        until(page, "window.eyas?.state.stage === 'countdown'", seconds=120)
        assert page.locator("#board").is_hidden()
        page.keyboard.down("ArrowUp")
        until(page, "window.eyas.state.stage === 'flying' && window.eyas.state.time > 0.5")
        if number == 2:
            page.click("#leave")
    until(page, "document.getElementById('line').textContent.startsWith('Flight 3 of 4,')", 120)
    log = read_log(served.folder / "people" / "people.flights")
    assert [bool(own.left) for own in log.flown.values()] == [False, True]
    assert [own.device for own in log.attempts.values()] == ["keyboard", "keyboard"]
    assert any(action[0] == 20.0 for _, action in log.flown[1].actions)
    assert not problems
