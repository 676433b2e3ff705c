"""The demo in a window: the same keys, and the reward over the picture."""

import time
from typing import Any

from PIL import Image, ImageDraw, ImageFont

from eyas.core.errors import EyasError
from eyas.envs.window import load_pygame
from eyas.modes.demo.cockpit import Cockpit
from eyas.modes.demo.controls import Control
from eyas.modes.demo.messages import Do, Look, Message, Pace
from eyas.modes.demo.orders import carry_out
from eyas.modes.demo.pace import FRAME
from eyas.modes.demo.readings import readings

__all__ = ["DemoWindow", "run_window"]

SIZE = 960, 540

_PLAIN = {
    "K_UP": Control.FORWARD,
    "K_DOWN": Control.BACK,
    "K_LEFT": Control.TURN_LEFT,
    "K_RIGHT": Control.TURN_RIGHT,
    "K_w": Control.CAMERA_UP,
    "K_s": Control.CAMERA_DOWN,
    "K_a": Control.CAMERA_LEFT,
    "K_d": Control.CAMERA_RIGHT,
    "K_c": Control.CAMERA_CENTRE,
}
_SHIFTED = {
    "K_UP": Control.CLIMB,
    "K_DOWN": Control.SINK,
    "K_LEFT": Control.LEFT,
    "K_RIGHT": Control.RIGHT,
}
_VIEWS = {"K_1": "drone", "K_2": "chase", "K_3": "top"}
_ONCE = {"K_n": "next_target", "K_b": "parked_target", "K_r": "reset"}


def run_window(cockpit: Cockpit, seconds: float | None) -> None:
    """Fly in a window until it is closed.

    Args:
        cockpit: What is flown.
        seconds: Close it after this time; None: never.

    Raises:
        MissingExtraError: pygame is not installed.
    """
    window = DemoWindow(load_pygame(), cockpit)
    begun = time.monotonic()
    cockpit.clock.skip(begun)
    try:
        while window.hear() and (seconds is None or time.monotonic() < begun + seconds):
            now = time.monotonic()
            cockpit.hold(window.held(), (0, 0.0), now)
            cockpit.advance(now)
            window.show()
            time.sleep(max(now + FRAME - time.monotonic(), 0.0))
    finally:
        window.close()


class DemoWindow:
    """The window.

    Args:
        pygame: The module.
        cockpit: What is flown and shown.
    """

    def __init__(self, pygame: Any, cockpit: Cockpit) -> None:  # noqa: ANN401  # a module
        self._pygame, self._cockpit = pygame, cockpit
        self._down: set[int] = set()
        pygame.display.init()
        pygame.display.set_caption("Eyas: fly it")
        self._screen = pygame.display.set_mode(SIZE, pygame.RESIZABLE)

    def close(self) -> None:
        """Close it."""
        self._pygame.display.quit()

    def hear(self) -> bool:
        """Carry out what was pressed once; return whether the window stays open."""
        pygame = self._pygame
        for event in pygame.event.get():
            if event.type == pygame.QUIT:
                return False
            if event.type == pygame.WINDOWFOCUSLOST:
                self._down.clear()
            elif event.type == pygame.KEYUP:
                self._down.discard(event.key)
            elif event.type == pygame.KEYDOWN:
                if event.key == pygame.K_ESCAPE:
                    return False
                self._down.add(event.key)
                self._press(event.key)
        return True

    def _press(self, key: int) -> None:
        message = self._meant(key)
        if message is not None:
            try:
                carry_out(self._cockpit, message)
            except EyasError as error:
                self._pygame.display.set_caption(f"Eyas: {error}")

    def _meant(self, key: int) -> Message | None:
        pygame, cockpit = self._pygame, self._cockpit
        for name, view in _VIEWS.items():
            if key == getattr(pygame, name):
                return Look.model_validate({"view": view, "overlay": cockpit.overlay})
        for name, what in _ONCE.items():
            if key == getattr(pygame, name):
                return Do.model_validate({"what": what})
        if key == pygame.K_p:
            return Pace(speed=0.0 if cockpit.clock.speed else 1.0)
        if key == pygame.K_o:
            cockpit.overlay = not cockpit.overlay
        return None

    def held(self) -> dict[Control, float]:
        """Return the controls that are held."""
        pygame = self._pygame
        table = _PLAIN | _SHIFTED if pygame.key.get_mods() & pygame.KMOD_SHIFT else _PLAIN
        down = {getattr(pygame, name): control for name, control in table.items()}
        return {down[key]: 1.0 for key in self._down if key in down}

    def show(self) -> None:
        """Draw the picture, with the overlay and a line of numbers."""
        cockpit, wide = self._cockpit, self._screen.get_size()
        cockpit.size.fit(*wide)
        begun = time.perf_counter()
        size = cockpit.size.now
        picture = Image.fromarray(cockpit.screen.draw(*size)).resize(wide)
        drawing = ImageDraw.Draw(picture)
        if cockpit.overlay:
            _draw_marks(drawing, cockpit.screen.marks(*size), wide)
        for part in cockpit.screen.body(*size) or ():
            outline = [(x * wide[0], y * wide[1]) for x, y in part]
            if len(outline) > 2:
                drawing.polygon(outline, fill=(238, 241, 245), outline=(61, 68, 77))
        _draw_line(drawing, _line(cockpit), wide)
        surface = self._pygame.image.frombytes(picture.tobytes(), wide, "RGB")
        self._screen.blit(surface, (0, 0))
        self._pygame.display.flip()
        cockpit.size.spent(time.perf_counter() - begun)


def _line(cockpit: Cockpit) -> str:
    now = readings(cockpit.flight)
    reasons = f"   would end: {', '.join(now['reasons'])}" if now["reasons"] else ""
    return (
        f"reward {now['reward']:.2f}   p {now['p']:.2f}   offset {now['offset']:.1f} m   "
        f"height {now['height']:.1f} m   speed {now['speed']:.1f} m/s   "
        f"steps {now['steps']}   time {now['time']:.1f} s{reasons}"
    )


def _draw_line(drawing: ImageDraw.ImageDraw, text: str, size: tuple[int, int]) -> None:
    drawing.rectangle((0, size[1] - 30, *size), fill=(12, 17, 24))
    font = ImageFont.load_default(16)
    drawing.text((12, size[1] - 24), text, fill=(230, 235, 242), font=font)


def _draw_marks(drawing: ImageDraw.ImageDraw, marks: dict[str, Any], size: tuple[int, int]) -> None:
    def at(points: list[list[float]]) -> list[tuple[float, float]]:
        return [(x * size[0], y * size[1]) for x, y in points]

    for name, colour in (("reward", (255, 199, 31)), ("seen", (64, 204, 255))):
        outline = at(marks[name])
        if len(outline) > 2:
            drawing.line([*outline, outline[0]], fill=colour, width=3)
    for line in marks["lines"]:
        drawing.line(at(line), fill=(64, 204, 255), width=1)
    if marks["tip"] is not None:
        ((x, y),) = at([marks["tip"]])
        gem = [(x, y - 4), (x - 7, y - 15), (x, y - 22), (x + 7, y - 15)]
        drawing.polygon(gem, fill=(255, 69, 128))
