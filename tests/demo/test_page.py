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


def test_the_best_flights_are_listed_in_both_languages(page):
    page.evaluate(
        """import("/duel.js").then(({ DuelBoard }) => {
          const board = new DuelBoard();
          board.keep({ policy: "follow", scores: { you: 3, policy: 2 } }, "x");
        })"""
    )
    until(page, "document.getElementById('best').textContent.includes('follow 2')")
    page.click("#language")
    page.evaluate("import('/duel.js').then(({ DuelBoard }) => new DuelBoard().list('x'))")
    until(page, "document.getElementById('best').textContent.includes('此处最佳成绩')")


def test_a_duel_counts_down_over_the_picture(page):
    page.click("#duel")
    until(page, "document.getElementById('countdown').textContent === '2'")
    assert page.locator("#countdown").is_visible()
    until(page, "document.getElementById('countdown').hidden")


COVERED = """(() => {
  const hits = (a, b) =>
    Math.min(a.right, b.right) > Math.max(a.left, b.left) + 1 &&
    Math.min(a.bottom, b.bottom) > Math.max(a.top, b.top) + 1;
  const over = document.querySelectorAll("#top, #notice, #watching, #flies, #minimap, #panel");
  const found = [];
  for (const button of document.querySelectorAll("#touch button")) {
    const place = button.getBoundingClientRect();
    const middle = document.elementFromPoint(place.x + place.width / 2, place.y + place.height / 2);
    if (middle !== button) found.push(`${button.title}: behind ${middle?.id}`);
    for (const other of over) {
      if (other.hidden || !hits(place, other.getBoundingClientRect())) continue;
      found.push(`${button.title}: under ${other.id}`);
    }
  }
  return found;
})()"""


@pytest.fixture
def phone(browser, served):
    """Opens the page on a phone of a size; it has the controls."""
    with contextlib.ExitStack() as stack:

        def opened(width, height):
            size = {"width": width, "height": height}
            how = {"viewport": size, "has_touch": True, "is_mobile": True}
            page = stack.enter_context(browser.new_context(**how)).new_page()
            page.goto(served.address)
            until(page, "window.eyas !== undefined && document.getElementById('watching').hidden")
            return page

        yield opened


@pytest.mark.parametrize("size", [(390, 844), (844, 390), (360, 640), (640, 360)])
def test_on_a_phone_nothing_covers_the_controls(phone, size):
    page = phone(*size)
    page.fill("#link", "x" * 60)
    page.press("#link", "Enter")  # refused in some lines
    until(page, "!document.getElementById('notice').hidden")
    page.evaluate("scrollTo(0, 0)")
    assert page.evaluate(COVERED) == []
    assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")
    tops = page.evaluate("[...document.querySelectorAll('header > *')].map((e) => e.offsetTop)")
    assert len({top // 30 for top in tops if top}) <= 2  # rows of the head
    panel = page.locator("#panel").bounding_box()
    for value in page.locator("#kinds b").all():
        box = value.bounding_box()
        assert box["x"] + box["width"] <= panel["x"] + panel["width"]


def test_who_watches_has_no_controls_on_the_screen(page, phone):
    page.bring_to_front()
    page.set_viewport_size({"width": 390, "height": 844})
    other = page.context.new_page()
    other.goto(page.url)
    until(other, "window.eyas && !document.getElementById('watching').hidden")
    assert other.locator("[data-control=climb]").is_hidden()
    assert page.locator("[data-control=climb]").is_visible()
    other.close()


def test_what_is_fun_comes_first(page):
    buttons = page.locator("#panel button").all()
    assert [button.get_attribute("id") for button in buttons[:3]] == ["duel", "fly", "film"]
    assert page.locator("#duel").bounding_box()["y"] < 60


UNNAMED = """[...document.querySelectorAll("button, select, input, a[href], canvas")]
  .filter((e) => !(e.ariaLabel || e.labels?.length || /\\p{L}/u.test(e.textContent)))
  .map((e) => e.outerHTML)"""


def test_every_control_has_a_name_and_can_be_reached_by_keys(page):
    assert page.evaluate(UNNAMED) == []
    wanted = page.evaluate(
        "[...document.querySelectorAll(':is(header, #panel) :is(button, select, input, a)')]"
        ".filter((e) => e.checkVisibility() && !e.disabled).length"
    )
    page.evaluate("document.activeElement.blur()")
    reached = []
    for _ in range(wanted):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.outerHTML"))
    assert len(set(reached)) == wanted
    assert 'id="map"' in reached[0]


def test_the_keyboard_operates_buttons_and_sliders_and_stays_there(page):
    page.focus("#view_scale")
    before = float(page.input_value("#view_scale"))
    page.keyboard.press("ArrowRight")
    assert float(page.input_value("#view_scale")) > before
    assert page.evaluate("document.activeElement.id") == "view_scale"
    page.focus("#overlay")
    page.keyboard.press("Enter")
    until(page, "eyas.state.marks")
    assert page.evaluate("document.activeElement.id") == "overlay"


LATIN = """(() => {
  const english = (text) => /[a-z]{3}/.test(text) && !/\\p{Script=Han}/u.test(text);
  const found = new Set(), nodes = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const named = "kbd, #language, select, .brand, label[for], #link-line, #line, #numbers, h1";
  while (nodes.nextNode()) {
    const { data, parentElement } = nodes.currentNode;
    if (english(data) && !parentElement.closest(named)) found.add(data);
  }
  for (const name of ["title", "aria-label", "placeholder"]) {
    for (const element of document.querySelectorAll(`[${name}]:not(#language, option, dd)`)) {
      const text = element.getAttribute(name);
      if (english(text)) found.add(text);
    }
  }
  return [...found];
})()"""


def test_a_chinese_browser_gets_all_of_the_page_in_chinese(browser, served, page):
    context = browser.new_context(locale="zh-CN")
    chinese = context.new_page()
    for path in ("", "reference.html"):
        chinese.goto(served.address + path)
        until(chinese, "document.documentElement.lang === 'zh-CN'")
        if not path:
            until(chinese, "window.eyas !== undefined && window.eyas.world")
        assert chinese.evaluate(LATIN) == [], path
    context.close()


def test_the_switch_changes_the_language_and_is_kept(page):
    assert page.locator("#duel").text_content() == "You against it: 60 s"
    page.click("#language")
    until(page, "document.getElementById('duel').textContent === '与它对决\uff1a60 秒'")
    assert page.evaluate("document.documentElement.lang") == "zh-CN"
    assert page.locator("#target option").first.text_content() == "汽车和其他车辆"
    page.reload()
    until(page, "document.getElementById('fly').textContent === '让它飞'")
    page.click("#language")
    until(page, "document.getElementById('fly').textContent === 'Let it fly'")
    assert page.locator("#target option").first.text_content() == "cars and more"


def test_targets_are_in_words_in_both_languages(page):
    said = page.evaluate(
        """import("/words.js").then(({ named, switchLanguage }) => {
          switchLanguage();
          const all = ["a small green car", "a dark blue sedan", "a red bus", "an orange scooter",
            "a pedestrian in an orange down jacket", "a delivery fox"].map(named);
          switchLanguage();
          return all;
        })"""
    )
    chinese = [
        "绿色小汽车",
        "深蓝色轿车",
        "红色公交车",
        "橙色踏板摩托车",
        "穿橙色羽绒服的行人",
        "delivery fox",
    ]
    assert said[:5] == chinese[:5]
    until(page, "/^an? [a-z]/.test(eyas.state.target.words)")


def test_the_link_of_a_film_plays_it_and_a_wrong_one_is_one_line(page):
    page.click("#film")
    until(page, "eyas.state.film && document.getElementById('link').value !== ''", seconds=120)
    link = page.input_value("#link")
    assert page.url.endswith(f"#{link}")
    until(page, "eyas.state.size[0] === 640 && eyas.state.size[1] === 480")
    page.keyboard.press("ArrowUp")
    until(page, "eyas.state.film === null")
    page.fill("#link", link.replace("simpleway", "complexway"))
    page.press("#link", "Enter")
    until(page, "document.getElementById('notice').textContent.startsWith('link: map: ')")
    page.fill("#link", link)
    page.press("#link", "Enter")
    until(page, "eyas.state.film")
    assert state(page)["film"]["link"] == link


def test_flights_for_the_leaderboard_begin_in_the_page_and_lead_back(page):
    page.select_option("#protocol", "paper")
    page.click("#record-for")
    until(page, "document.title.includes('leaderboard')")
    page.click("#back")  # once the flight is made, which goes on meanwhile
    until(page, "document.title === 'Eyas: fly it' && window.eyas !== undefined", seconds=200)
