"""What keys and gamepads say, and a page that outlives its server, in a real Chromium."""

import contextlib
import json
import time

import pytest

from .conftest import until

pytestmark = pytest.mark.slow  # what its tests share takes long to make

KEYS = {
    "ArrowUp": "forward",
    "ArrowDown": "back",
    "ArrowLeft": "turn_left",
    "ArrowRight": "turn_right",
    "w": "camera_up",
    "s": "camera_down",
    "a": "camera_left",
    "d": "camera_right",
    "c": "camera_centre",
    "Shift+ArrowUp": "climb",
    "Shift+ArrowDown": "sink",
    "Shift+ArrowLeft": "left",
    "Shift+ArrowRight": "right",
}


@pytest.fixture
def said(browser, served):
    """A page, and all that it says."""
    with contextlib.ExitStack() as stack:
        context = stack.enter_context(browser.new_context())
        page, messages = context.new_page(), []

        def listen(socket):
            socket.on("framesent", lambda text: messages.append(json.loads(text)))

        page.on("websocket", listen)
        page.goto(served.address)
        until(page, "window.eyas !== undefined")
        yield page, messages


def held(page, messages):
    """Return what the page says next that it holds."""
    messages.clear()
    end = time.monotonic() + 10
    while time.monotonic() < end:
        page.evaluate("1")  # lets events of the page come in
        found = [message for message in messages if message["message"] == "keys"]
        if found:
            return found[-1]["held"]
    raise AssertionError("nothing is said")


def test_each_key_holds_its_control_and_no_other(said):
    page, messages = said
    for key, control in KEYS.items():
        *shift, letter = key.split("+")
        for part in (*shift, letter):
            page.keyboard.down(part)
        assert held(page, messages) == {control: 1}, key
        for part in (letter, *shift):
            page.keyboard.up(part)
        assert held(page, messages) == {}, key


def test_several_keys_are_held_at_once(said):
    page, messages = said
    for key in ("ArrowUp", "ArrowLeft", "w"):
        page.keyboard.down(key)
    assert held(page, messages).keys() == {"forward", "turn_left", "camera_up"}


def test_sticks_of_a_gamepad_are_held_as_far_as_they_are_pushed(said):
    page, messages = said
    page.evaluate(
        """() => {
          const buttons = Array.from({ length: 17 }, (_, i) => ({ pressed: i === 14 }));
          navigator.getGamepads = () => [null, { axes: [0.5, -1, 0.05, -0.75], buttons }];
          dispatchEvent(new Event("gamepadconnected"));
        }"""
    )
    pushed = {"turn_right": 0.5, "climb": 1, "forward": 0.75, "camera_left": 1}
    assert held(page, messages) == pushed


def test_keys_in_a_menu_do_not_fly(said):
    page, messages = said
    page.focus("#policy")
    page.keyboard.down("ArrowDown")
    assert held(page, messages) == {}


def test_a_page_comes_back_when_the_server_does(browser, serve):
    first = serve()
    with contextlib.ExitStack() as stack:
        context = stack.enter_context(browser.new_context())
        page = context.new_page()
        page.goto(first.address)
        until(page, "window.eyas !== undefined")
        first.stop()
        until(page, "document.body.classList.contains('offline')")
        assert "No connection" in page.locator("#notice").text_content()
        serve("--port", str(first.port))
        until(page, "!document.body.classList.contains('offline')")
        page.keyboard.down("ArrowUp")
        until(page, "eyas.state.speed > 5")
