"""All that is going on in the demo: the flight, who flies, what is shown and recorded."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from eyas.demo.choices import Builder, WorldChoice
from eyas.demo.controllers import Controller, Duel
from eyas.demo.controls import Held, command_of
from eyas.demo.film import SIZE as FILM_SIZE
from eyas.demo.film import Film, FilmLink
from eyas.demo.flight import DemoFlight
from eyas.demo.frame import DemoFrame
from eyas.demo.live import LiveDemo
from eyas.demo.offer import Offer
from eyas.demo.readings import readings, traffic
from eyas.demo.recording import DemoRecording
from eyas.demo.views import Screen
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.settings.config import EyasConfig

FRAME = 1.0 / 30.0  # Between frames [s]
LONGEST = 0.1
"""Longest frame, in seconds of the clock: a slower machine flies slower, not farther at a time."""
SMALLEST, FIRST, LARGEST = 480 * 270, 640 * 360, 1280 * 720  # Pixels of a picture
STEP = 1.3
"""From one number of pixels to the next: seldom, for each change takes a whole picture of H.264."""
PATIENCE, MOST_PATIENCE = 60, 240
"""Frames with time to spare after which pictures grow; doubled each time they shrink."""


class Clock:
    """Turns time into physics steps, at a speed in seconds of the simulation in a second."""

    def __init__(self, now: float) -> None:
        self.speed = 1.0
        self._last, self._owed = now, 0.0

    def skip(self, now: float) -> None:
        """Leave out the time since the last steps."""
        self._last = now

    def steps(self, now: float) -> int:
        """Return the steps that are due."""
        self._owed += min(now - self._last, LONGEST) * self.speed * PHYSICS_RATE
        self._last = now
        due = int(self._owed)
        self._owed -= due
        return due


class AdaptiveSize:
    """Chooses the largest picture that the machine can draw in time, in the window's shape.

    Attributes:
        now: Width and height [pixels].
    """

    def __init__(self) -> None:
        self._window = (640, 360)
        self._pixels = float(FIRST)
        self._cost = 0.5 * FRAME
        self._easy, self._patience = 0, PATIENCE
        self.now = (640, 360)

    def fit(self, width: int, height: int) -> None:
        """Take the size of the window [pixels]."""
        self._window = width, height
        self._choose()

    def spent(self, seconds: float) -> None:
        """Take the time that a picture took; shrink at once, grow after a while."""
        self._cost += 0.1 * (seconds - self._cost)
        self._easy = self._easy + 1 if STEP * self._cost < 0.6 * FRAME else 0
        if self._cost > 0.8 * FRAME and self._pixels > SMALLEST:
            self._patience = min(2 * self._patience, MOST_PATIENCE)
            self._change(1.0 / STEP)
        elif self._easy >= self._patience and self._pixels < LARGEST:
            self._change(STEP)

    def _change(self, factor: float) -> None:
        self._pixels = min(max(self._pixels * factor, SMALLEST), LARGEST)
        self._cost *= factor
        self._easy = 0
        self._choose()

    def _choose(self) -> None:
        width, height = self._window
        shape = min(max(width / height, 0.4), 3.0)
        pixels = min(self._pixels, max(width * height, SMALLEST))
        across = max(round((pixels * shape) ** 0.5 / 16) * 16, 16)
        self.now = across, max(round(across / shape / 2) * 2, 16)


SILENCE = 0.5  # Time after which the keys of a page that says nothing are released [s]
CHUNK = 10  # Largest number of physics steps between two looks at the reward
TRAFFIC = 3  # Frames from one list of all vehicles to the next


class Session:
    """State of the demo, in the thread that flies."""

    def __init__(self, config: EyasConfig, offer: Callable[[], Offer], recordings: Path) -> None:
        self.find_offer, self.recordings = offer, recordings
        self.offer = offer()
        self.size, self.clock = AdaptiveSize(), Clock(time.monotonic())
        self.overlay = True
        self.recording: DemoRecording | None = None
        self.live: LiveDemo | None = None
        self.film: Film | None = None
        self.duel: Duel | None = None
        self.duel_later: str | None = None
        """The policy of a duel that begins when the new world is built."""
        self.film_later: FilmLink | None = None  # A film that begins then
        self.sides_change = False  # Whether the next flight of the duel is to begin
        plan = WorldChoice(config, config.traffic.max_vehicles)
        self.builder = Builder(plan)
        self.begin_flight(plan.build())
        self._frames = 0

    def begin_flight(self, flight: DemoFlight) -> None:
        """Go on with another flight."""
        self.flight = flight
        self.screen = Screen(flight)
        self.hand_over(None, None)
        self.hold({}, (0, 0.0), 0.0)
        self.extra_steps = 0

    def hand_over(self, controller: Controller | None, name: str | None) -> None:
        """Let a controller fly; None: the keys."""
        self.controller, self.controller_name, self._left = controller, name, 0
        self.film = None

    def hold(self, held: Held, source: tuple[int, float], now: float) -> None:
        """Hold controls, until something else is said, or nothing for half a second.

        Args:
            source: Sequence number of the message, and the page's time of the last change [ms].
            now: The time [s].
        """
        self._held, self.source, self._heard = held, source, now

    def advance(self, now: float) -> None:
        """Fly until now.

        Raises:
            EyasError: A policy failed, or a frame could not be written.
        """
        steps = self.clock.steps(now) + self.extra_steps
        self.extra_steps = 0
        if self.duel is not None and self.duel.waits(now):
            return
        if now - self._heard > SILENCE:
            self._held = {}
        while steps > 0 and not self.sides_change and not (self.film and self.film.over):
            steps -= self._advance_some(steps, now)
        if self.live is not None:
            self.live.show(self.flight, now)

    def _advance_some(self, steps: int, now: float) -> int:
        """Fly some of the steps that are due; return how many."""
        some = min(steps, CHUNK)
        if self.controller is None:
            command = command_of(self._held)
        else:
            if self._left <= 0:
                self._decided, self._left = self.controller.decide()
            command, some = self._decided, min(some, self._left)
        if self.recording is not None:
            some = min(some, self.recording.steps_left)
        if self.film is not None:
            some = min(some, self.film.steps_left)
        self.flight.fly(command, some, self._held)
        self._left -= some
        if self.recording is not None:
            self.recording.count(command, some)
        if self.film is not None:
            self.film.count(some)
        if self.duel is not None:
            self._score(some, now)
        return some

    def _score(self, steps: int, now: float) -> None:
        duel = self.duel
        assert duel is not None
        reward = float(self.flight.simulation.snapshot.episodes.reward[0])
        self.sides_change |= duel.count(reward, steps, now)

    def frame(self, now: float) -> DemoFrame:
        """Draw the next frame."""
        begun = time.perf_counter()
        self._frames += 1
        if self.film is not None and self.screen.view == "drone":
            state = self._state(now, *FILM_SIZE)
            return DemoFrame(self._frames, state, self.film.picture)
        width, height = self.size.now
        rgb = self.screen.draw(width, height)
        frame = DemoFrame(self._frames, self._state(now, width, height), rgb)
        self.size.spent(time.perf_counter() - begun)
        return frame

    def _state(self, now: float, width: int, height: int) -> dict[str, Any]:
        """Return what the page gets beside the picture."""
        state = readings(self.flight) | {
            "frame": self._frames,
            "sequence": self.source[0],
            "input": self.source[1],
            "view": self.screen.view,
            "size": [width, height],
            "speed_of_time": self.clock.speed,
            "flies": self.controller_name,
            "recorded": None if self.recording is None else self.recording.frames,
            "film": None if self.film is None else self.film.state(),
            "duel": None if self.duel is None else self.duel.state(now),
            "body": self.screen.body(width, height),
            "marks": self.screen.marks(width, height) if self.overlay else None,
        }
        if self._frames % TRAFFIC == 1:
            state["traffic"] = traffic(self.flight)
        return state
