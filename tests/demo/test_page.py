"""The page in a real Chromium; collected where one is installed, with playwright."""

import contextlib
import time

import pytest

from .conftest import Viewer, restore, until
from .slow_line import SlowLine

pytestmark = pytest.mark.slow  # what its tests share takes long to make


@pytest.fixture
def page(browser, served):
    """The page, with frames; what it has asked for and complained of is checked at the end."""
    before = Viewer(served.socket)
    restore(before)
    before.close()
    context = browser.new_context(viewport={"width": 900, "height": 560})
    page = context.new_page()
    asked, problems = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on("console", lambda line: problems.append(line.text) if line.type == "error" else None)
    page.goto(served.address)
    until(page, "window.eyas !== undefined")
    yield page
    context.close()
    own = (served.address, served.address.replace("http", "ws"), "blob:", "data:")
    assert not [url for url in asked if not url.startswith(own)]
    assert not problems


def state(page):
    return page.evaluate("window.eyas.state")


def stand_still(page):
    page.click("#reset")
    until(page, "eyas.state.steps < 500 && eyas.state.speed === 0")


def test_held_keys_fly_and_the_picture_changes(page):
    stand_still(page)
    before, picture = state(page), page.locator("#picture").screenshot()
    page.keyboard.down("ArrowUp")
    until(page, "eyas.state.speed > 10")
    page.keyboard.up("ArrowUp")
    until(page, "eyas.state.speed < 0.1")
    assert state(page)["drone"][:2] != before["drone"][:2]
    assert page.locator("#picture").screenshot() != picture
    assert page.evaluate("eyas.latency") > 0


def test_shift_changes_the_meaning_of_arrows(page):
    stand_still(page)
    height = state(page)["height"]
    page.keyboard.down("Shift")
    page.keyboard.down("ArrowUp")
    until(page, f"eyas.state.height > {height + 0.5}")
    page.keyboard.up("Shift")  # the arrow is still held, and flies forward now
    until(page, "eyas.state.speed > 5")
    page.keyboard.up("ArrowUp")
    until(page, "eyas.state.speed < 0.1 && eyas.state.climb === 0")


def test_a_page_without_focus_lets_go(page):
    stand_still(page)
    page.keyboard.down("ArrowDown")
    until(page, "eyas.state.speed > 5")
    page.evaluate("window.dispatchEvent(new Event('blur'))")
    until(page, "eyas.state.speed < 0.1")
    page.keyboard.up("ArrowDown")


def test_buttons_on_the_screen_are_held_too(page):
    page.set_viewport_size({"width": 390, "height": 844})
    stand_still(page)
    box = page.locator('[data-control="turn_left"]').bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()
    until(page, "eyas.state.yaw_rate > 40")
    page.mouse.up()
    until(page, "Math.abs(eyas.state.yaw_rate) < 0.1")


def test_sliders_change_the_reward(page):
    page.click("#parked")
    for scale, right in [("4", "> 0.5"), ("0.1", "< 0.2"), ("4", "> 0.5")]:
        page.locator("#view_scale").fill(scale)
        until(page, f"eyas.state.target.parked && eyas.state.reward {right}")


def test_a_click_on_the_parked_car_follows_it(page):
    page.click("#parked")
    until(page, "eyas.state.target.parked && eyas.state.marks")
    x, y = state(page)["marks"]["target"]
    page.click("#next")
    until(page, "!eyas.state.target.parked")
    box = page.locator("#picture").bounding_box()
    page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
    until(page, "eyas.state.target.parked")


COLOURS = """(() => {
  const { width, height } = document.getElementById("picture");
  const all = document.getElementById("picture").getContext("2d").getImageData(0, 0, width, height);
  const mean = [0, 0, 0];
  all.data.forEach((value, i) => { if (i % 4 < 3) mean[i % 4] += value / (width * height); });
  return mean;
})()"""


def test_h264_shows_the_same_colours(page):
    if not page.evaluate("import('/pictures.js').then((it) => it.decodesH264())"):
        pytest.skip("this Chromium does not decode H.264")
    page.keyboard.press("o")
    page.click("#pause")
    shown = {}
    for coding, kind in [("h264", "delta"), ("jpeg", "jpeg")]:
        page.select_option("#coding", coding)
        until(page, f"eyas.state.picture === '{kind}' && !eyas.state.marks")
        time.sleep(1.0)  # some more frames, which sharpen what stands still
        shown[coding] = page.evaluate(COLOURS)
    page.click("#pause")
    assert shown["h264"] == pytest.approx(shown["jpeg"], abs=3.0)


def test_a_page_that_cannot_decode_h264_goes_on_with_jpeg(page):
    if not page.evaluate("import('/pictures.js').then((it) => it.decodesH264())"):
        pytest.skip("this Chromium does not decode H.264")
    page.evaluate(
        """() => {
          const Own = EncodedVideoChunk;
          window.EncodedVideoChunk = function (init) {
            return new Own({ ...init, data: new Uint8Array(50) });
          };
        }"""
    )
    page.select_option("#coding", "h264")
    until(page, "document.getElementById('coding').value === 'jpeg'")
    frame = state(page)["frame"]
    until(page, f"eyas.state.frame > {frame + 20} && eyas.state.picture === 'jpeg'")


def test_a_slow_line_gets_h264_by_itself(browser, served):
    with contextlib.ExitStack() as stack:
        line = stack.enter_context(contextlib.closing(SlowLine(served.port, 150_000)))
        context = stack.enter_context(browser.new_context(viewport={"width": 900, "height": 560}))
        page = context.new_page()
        page.goto(f"http://127.0.0.1:{line.port}/")
        until(page, "window.eyas !== undefined")
        if page.evaluate("document.getElementById('coding').disabled"):
            pytest.skip("this Chromium does not decode H.264")
        until(page, "eyas.state.picture === 'delta'")


def test_menus_change_the_weather(page):
    page.select_option("#weather", "night")
    until(page, "!document.getElementById('notice').hidden")
    until(page, "document.getElementById('notice').hidden", seconds=120)
    assert page.locator("#weather").input_value() == "night"


def test_menus_change_the_tracker_and_the_light(page):
    for menu, choice in [("tracker", "flown"), ("light", "dark"), ("hour", "9")]:
        page.select_option(f"#{menu}", choice)
        until(page, f"eyas.world.{menu} == '{choice}'", seconds=120)
        assert page.locator(f"#{menu}").input_value() == choice


def test_help_opens_and_closes(page):
    page.keyboard.press("?")
    assert page.locator("#help").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("#help").is_visible()


def test_a_second_page_watches_and_can_take_over(page, browser, served):
    context = browser.new_context()
    second = context.new_page()
    second.goto(served.address)
    until(second, "window.eyas !== undefined")
    assert second.locator("#watching").is_visible()
    second.click("#take")
    until(second, "document.getElementById('watching').hidden")
    until(page, "!document.getElementById('watching').hidden")
    context.close()
    until(page, "document.getElementById('watching').hidden")


def test_sliders_have_names(page):
    names = ["view_range", "view_scale", "distance_range", "distance_scale"]
    for name in names:
        assert page.get_by_role("slider", name=name).count() == 1


def test_a_duel_counts_down_over_the_picture(page):
    page.click("#duel")
    until(page, "document.getElementById('countdown').textContent === '2'")
    assert page.locator("#countdown").is_visible()
    until(page, "document.getElementById('countdown').hidden")


def test_on_a_phone_held_sideways_nothing_covers_the_controls(browser, served, page):
    context = browser.new_context(
        viewport={"width": 844, "height": 390}, has_touch=True, is_mobile=True
    )
    phone = context.new_page()
    phone.goto(served.address)
    until(phone, "window.eyas !== undefined && !document.getElementById('watching').hidden")
    notice = phone.locator("#watching").bounding_box()
    for button in phone.locator("#touch button").all():
        box = button.bounding_box()
        assert box["y"] >= notice["y"] + notice["height"] or (
            box["x"] >= notice["x"] + notice["width"] or box["x"] + box["width"] <= notice["x"]
        )
    panel = phone.locator("#panel").bounding_box()
    for value in phone.locator("#kinds b").all():
        box = value.bounding_box()
        assert box["x"] + box["width"] <= panel["x"] + panel["width"]
    context.close()
