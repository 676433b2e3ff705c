"""What each message of the pilot's page does."""

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from eyas.core.errors import ConfigError, EyasError, UnknownNameError
from eyas.modes.demo import messages as said
from eyas.modes.demo.choices import plan_of, world_of
from eyas.modes.demo.cockpit import Cockpit
from eyas.modes.demo.duel import SEED, Duel
from eyas.modes.demo.pilots import BoxPilot, Pilot, PolicyPilot
from eyas.modes.demo.recording import Recording

__all__ = [
    "BOXES",
    "carry_out",
    "change_sides",
    "end_recording",
    "move_in",
    "open_with_a_chase",
    "reward_of",
    "world_now",
]

BOXES = "boxes"
"""The name under which a tracker outside flies."""

_UNFAIR = (said.Click, said.Do, said.Fly, said.Pace, said.Record, said.Reward)
"""What would change a flight against a policy."""

STEP = 4
"""Physics steps of a single step."""


def carry_out(cockpit: Cockpit, message: said.Message) -> dict[str, Any] | None:
    """Carry out what the pilot says; return what all should be told of it.

    Raises:
        EyasError: It cannot be done; the message is one line, and nothing has changed.
    """
    duel = cockpit.duel
    if duel is not None and duel.stage != "over" and isinstance(message, _UNFAIR):
        raise ConfigError("a flight against a policy goes on; give it up first")
    return _ORDERS[type(message)](cockpit, message)


def seat(cockpit: Cockpit, name: str) -> None:
    """Let a policy fly, or a tracker outside.

    Raises:
        EyasError: It cannot fly.
    """
    _require_known(cockpit, name)
    flight = cockpit.flight
    pilot: Pilot = BoxPilot(flight) if name == BOXES else PolicyPilot(name, flight)
    cockpit.hand_over(pilot, name)
    _appear(cockpit)


def _require_known(cockpit: Cockpit, name: str) -> None:
    """Refuse policies that are not offered: a page must not name code or files of this machine."""
    if name not in (*cockpit.policies, BOXES):
        raise UnknownNameError("policy", name, (*cockpit.policies, BOXES))


def open_with_a_chase(cockpit: Cockpit) -> None:
    """Show what this is about: a drone that follows a car, until a key is pressed."""
    cockpit.flight.follow_next()
    cockpit.flight.reset()
    cockpit.screen.view = "chase"
    with suppress(EyasError):  # then it stays where it is
        seat(cockpit, "follow")


def _appear(cockpit: Cockpit) -> None:
    """Begin a new flight over a target that is far from a drone that flies by itself."""
    if cockpit.pilot is not None and cockpit.flight.appear():
        end_recording(cockpit)


def change_sides(cockpit: Cockpit) -> None:
    """Begin the flight of the duel that is next; after the last, the keys fly.

    Raises:
        EyasError: The policy cannot fly.
    """
    cockpit.sides_change, duel = False, cockpit.duel
    cockpit.hand_over(None, None)
    if duel is None or duel.stage == "over":
        return
    cockpit.flight.reset(SEED)
    if duel.stage == "policy":
        seat(cockpit, duel.policy)


def end_recording(cockpit: Cockpit) -> dict[str, Any] | None:
    """End the recording, if there is one.

    Raises:
        OutputError: Writing failed.
    """
    recording, cockpit.recording = cockpit.recording, None
    if recording is None:
        return None
    recording.end()
    return {"say": f"Recorded {recording.frames} frames in {recording.folder}."}


def _keys(cockpit: Cockpit, message: said.Keys) -> None:
    pressed = any(share > 0.0 for share in message.held.values())
    flown = cockpit.duel is not None and cockpit.duel.stage == "policy"
    if pressed and cockpit.pilot is not None and not flown:
        cockpit.hand_over(None, None)
    source = message.sequence, message.time
    cockpit.hold(message.held, source, time.monotonic())


def _look(cockpit: Cockpit, message: said.Look) -> None:
    cockpit.screen.view, cockpit.overlay = message.view, message.overlay
    cockpit.size.fit(message.width, message.height)


def _click(cockpit: Cockpit, message: said.Click) -> None:
    actor = cockpit.screen.actor_at(message.x, message.y, *cockpit.size.now)
    if actor is not None:
        cockpit.flight.follow(actor)
        _appear(cockpit)


def _do(cockpit: Cockpit, message: said.Do) -> None:
    flight = cockpit.flight
    if message.what == "next_target":
        flight.follow_next()
        _appear(cockpit)
    elif message.what == "parked_target" and flight.world.parked >= 0:
        end_recording(cockpit)
        flight.follow(flight.world.parked)
        flight.reset()
    elif message.what == "reset":
        end_recording(cockpit)
        flight.reset()
    elif message.what == "step":
        cockpit.extra_steps = STEP


def _pace(cockpit: Cockpit, message: said.Pace) -> None:
    cockpit.clock.speed = message.speed


def _reward(cockpit: Cockpit, message: said.Reward) -> dict[str, Any]:
    cockpit.flight.change_reward(message)
    return reward_of(cockpit)


def reward_of(cockpit: Cockpit) -> dict[str, Any]:
    """Return the settings of the reward, for the sliders."""
    names = said.Reward.model_fields
    values = cockpit.flight.config.reward.model_dump(mode="json")
    return {"reward": {name: values[name] for name in names}}


def world_now(cockpit: Cockpit) -> dict[str, Any]:
    """Return what the menus show, and what is being built instead, if anything."""
    told = world_of(cockpit.builder.flown, cockpit.flight)
    return told | _busy(cockpit)


def _busy(cockpit: Cockpit) -> dict[str, Any]:
    world = cockpit.builder.plan.config.world
    return {"busy": f"{world.map}, {world.weather}" if cockpit.builder.busy else None}


def _world(cockpit: Cockpit, message: said.World) -> dict[str, Any]:
    cockpit.builder.order(plan_of(cockpit.builder.plan, message))
    return _busy(cockpit)


def move_in(cockpit: Cockpit) -> dict[str, Any] | None:
    """Go on in the world that was ordered, once it is built.

    Raises:
        EyasError: It could not be built; nothing has changed.
    """
    new = cockpit.builder.take()
    if new is None:
        return None
    ended = end_recording(cockpit) or {}
    cockpit.duel, rival = None, cockpit.duel_later
    cockpit.duel_later = None
    new.adopt_reward(cockpit.flight)
    view = cockpit.screen.view
    cockpit.board(new)
    cockpit.screen.view = view
    if rival is not None:
        _duel(cockpit, said.Duel(policy=rival))
    return ended | world_now(cockpit)


def _fly(cockpit: Cockpit, message: said.Fly) -> None:
    if message.policy is None:
        cockpit.hand_over(None, None)
    else:
        seat(cockpit, message.policy)


def _duel(cockpit: Cockpit, message: said.Duel) -> dict[str, Any] | None:
    if message.policy is None:
        cockpit.duel = cockpit.duel_later = None
        cockpit.hand_over(None, None)
        return None
    _require_known(cockpit, message.policy)
    if cockpit.builder.busy:
        cockpit.duel_later = message.policy
        return {"say": f"You against {message.policy}: begins in the new world."}
    seat(cockpit, message.policy)  # refuses now what could not fly later
    end_recording(cockpit)
    cockpit.clock.speed = 1.0
    cockpit.duel = Duel(message.policy, time.monotonic())
    change_sides(cockpit)
    return None


def _record(cockpit: Cockpit, message: said.Record) -> dict[str, Any] | None:
    if not message.on:
        return end_recording(cockpit)
    if cockpit.recording is None:
        folder = cockpit.recordings / time.strftime("%Y%m%d-%H%M%S")
        cockpit.recording = Recording(cockpit.flight, folder)
        return {"say": f"Recording into {folder}."}
    return None


def _box(cockpit: Cockpit, message: said.Box) -> None:
    if isinstance(cockpit.pilot, BoxPilot):
        cockpit.pilot.see(message.box, cockpit.size.now)


_ORDERS: dict[type[said.Message], Callable[[Cockpit, Any], dict[str, Any] | None]] = {
    said.Keys: _keys,
    said.Look: _look,
    said.Click: _click,
    said.Do: _do,
    said.Pace: _pace,
    said.Reward: _reward,
    said.World: _world,
    said.Fly: _fly,
    said.Duel: _duel,
    said.Record: _record,
    said.Box: _box,
}
