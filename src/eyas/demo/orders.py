"""What each message of the pilot's page does."""

import secrets
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from eyas.demo import messages as said
from eyas.demo.choices import choice_of, world_of
from eyas.demo.controllers import SEED, BoxController, Controller, Duel, PolicyController
from eyas.demo.film import FilmLink, begun, link_of, read_link
from eyas.demo.offer import BOXES
from eyas.demo.recording import DemoRecording
from eyas.demo.session import Session
from eyas.engine.core.errors import ConfigError, EyasError, UnknownNameError

_UNFAIR = (
    said.ClickMessage,
    said.DoMessage,
    said.FilmMessage,
    said.FlyMessage,
    said.PaceMessage,
    said.RecordMessage,
    said.RewardMessage,
)
"""What would change a flight against a policy."""

STEP = 4  # Physics steps of a single step


def carry_out(session: Session, message: said.Message) -> dict[str, Any] | None:
    """Carry out what the pilot says; return what all should be told of it.

    Raises:
        EyasError: It cannot be done; the message is one line, and nothing has changed.
    """
    duel = session.duel
    if duel is not None and duel.stage != "over" and isinstance(message, _UNFAIR):
        raise ConfigError("a flight against a policy goes on; give it up first")
    if type(message) not in _ORDERS:
        raise ConfigError("message: only in 'eyas demo --record-for PROTOCOL'")
    if isinstance(message, said.ClickMessage | said.DoMessage):
        session.film = None  # what flies it flies on, elsewhere
    return _ORDERS[type(message)](session, message)


def let_fly(session: Session, name: str) -> None:
    """Let a policy fly, or a tracker outside.

    Raises:
        EyasError: It cannot fly.
    """
    _require_known(session, name)
    flight = session.flight
    controller: Controller = (
        BoxController(flight) if name == BOXES else PolicyController(name, flight)
    )
    session.hand_over(controller, name)
    _appear(session)


def _require_known(session: Session, name: str) -> None:
    """Refuse policies that are not offered: a page must not name code or files of this machine."""
    if name not in (known := (*session.offer.policies, BOXES)):
        raise UnknownNameError("policy", name, known)


def open_with_a_chase(session: Session) -> None:
    """Show what this is about: a drone that follows a car, until a key is pressed."""
    session.flight.follow_next()
    session.flight.reset()
    session.screen.view = "chase"
    with suppress(EyasError):  # then it stays where it is
        let_fly(session, "follow")


def _appear(session: Session) -> None:
    """Begin a new flight over a target that is far from a drone that flies by itself."""
    if session.controller is not None and session.flight.appear():
        end_recording(session)


def change_sides(session: Session) -> None:
    """Begin the flight of the duel that is next; after the last, the keys fly.

    Raises:
        EyasError: The policy cannot fly.
    """
    session.sides_change, duel = False, session.duel
    session.hand_over(None, None)
    if duel is None or duel.stage == "over":
        return
    session.flight.reset(SEED)
    if duel.stage == "policy":
        let_fly(session, duel.policy)


def end_recording(session: Session) -> dict[str, Any] | None:
    """End the recording, if there is one.

    Raises:
        OutputError: Writing failed.
    """
    recording, session.recording = session.recording, None
    if recording is None:
        return None
    recording.end()
    return {"say": f"Recorded {recording.frames} frames in {recording.folder}."}


def _keys(session: Session, message: said.KeysMessage) -> None:
    pressed = any(share > 0.0 for share in message.held.values())
    flown = session.duel is not None and session.duel.stage == "policy"
    if pressed and session.controller is not None and not flown:
        session.hand_over(None, None)
    source = message.sequence, message.time
    session.hold(message.held, source, time.monotonic())


def _look(session: Session, message: said.LookMessage) -> None:
    session.screen.view, session.overlay = message.view, message.overlay
    session.size.fit(message.width, message.height)


def _click(session: Session, message: said.ClickMessage) -> None:
    actor = session.screen.actor_at(message.x, message.y, *session.size.now)
    if actor is not None:
        session.flight.follow(actor)
        _appear(session)


def _do(session: Session, message: said.DoMessage) -> None:
    flight = session.flight
    if message.what == "next_target":
        flight.follow_next()
        _appear(session)
    elif message.what == "parked_target" and flight.world.parked >= 0:
        end_recording(session)
        flight.follow(flight.world.parked)
        flight.reset()
    elif message.what == "reset":
        end_recording(session)
        flight.reset()
    elif message.what == "step":
        session.extra_steps = STEP


def _pace(session: Session, message: said.PaceMessage) -> None:
    session.clock.speed = message.speed


def _reward(session: Session, message: said.RewardMessage) -> dict[str, Any]:
    session.flight.change_reward(message)
    return reward_of(session)


def reward_of(session: Session) -> dict[str, Any]:
    """Return the settings of the reward, for the sliders."""
    names = said.RewardMessage.model_fields
    values = session.flight.config.reward.model_dump(mode="json")
    return {"reward": {name: values[name] for name in names}}


def world_now(session: Session) -> dict[str, Any]:
    """Return what the menus show, and what is being built instead, if anything."""
    told = world_of(session.builder.flown, session.flight, session.offer)
    return told | _busy(session)


def _busy(session: Session) -> dict[str, Any]:
    world = session.builder.plan.config.world
    return {"busy": f"{world.map}, {world.weather}" if session.builder.busy else None}


def _world(session: Session, message: said.WorldMessage) -> dict[str, Any]:
    choice = choice_of(session.builder.plan, message, session.offer)
    session.film_later = None
    session.builder.order(choice)
    return _busy(session)


def enter_new_world(session: Session) -> dict[str, Any] | None:
    """Go on in the world that was ordered, once it is built.

    Raises:
        EyasError: It could not be built; nothing has changed.
    """
    new = session.builder.take()
    if new is None:
        return None
    ended = end_recording(session) or {}
    session.duel, rival = None, session.duel_later
    film, session.duel_later, session.film_later = session.film_later, None, None
    new.adopt_reward(session.flight)
    view = session.screen.view
    session.begin_flight(new)
    session.screen.view = view
    if rival is not None:
        _duel(session, said.DuelMessage(policy=rival))
    shown = play(session, film) if film is not None else None
    return ended | world_now(session) | (shown or {})


def _fly(session: Session, message: said.FlyMessage) -> None:
    if message.policy is None:
        session.hand_over(None, None)
    else:
        let_fly(session, message.policy)


def _duel(session: Session, message: said.DuelMessage) -> dict[str, Any] | None:
    if message.policy is None:
        session.duel = session.duel_later = None
        session.hand_over(None, None)
        return None
    _require_known(session, message.policy)
    session.film_later = None
    if session.builder.busy:
        session.duel_later = message.policy
        return {"say": f"You against {message.policy}: begins in the new world."}
    let_fly(session, message.policy)  # refuses now what could not fly later
    end_recording(session)
    session.clock.speed = 1.0
    session.duel = Duel(message.policy, time.monotonic())
    change_sides(session)
    return None


def _film(session: Session, message: said.FilmMessage) -> dict[str, Any] | None:
    if message.link is not None:
        return play(session, read_link(message.link, session.offer))
    if message.policy is None:
        raise ConfigError("film: link or policy is missing")
    _require_known(session, message.policy)
    seed = secrets.randbelow(100_000)
    return play(session, link_of(session.builder.flown, message.policy, seed, session.offer))


def play(session: Session, link: FilmLink) -> dict[str, Any] | None:
    """Fly a film, once its world is there; return what all should be told.

    Raises:
        EyasError: Its policy cannot fly.
    """
    session.duel = session.duel_later = None
    if session.builder.busy or not link.same_world(session.builder.flown):
        session.film_later = link
        session.builder.order(link.choice)
        return _busy(session)
    ended = end_recording(session)
    film, controller = begun(link, session.flight)
    session.hand_over(controller, link.policy)
    session.film, session.clock.speed = film, 1.0
    return (ended or {}) | {"film": film.state()}


def end_film(session: Session) -> dict[str, Any] | None:
    """End the film that is over, if there is one; return what all should be told."""
    film = session.film
    if film is None or not film.over:
        return None
    session.hand_over(None, None)
    return {"film": film.state()}


def _record(session: Session, message: said.RecordMessage) -> dict[str, Any] | None:
    if not message.on:
        return end_recording(session)
    if session.recording is None:
        folder = session.recordings / time.strftime("%Y%m%d-%H%M%S")
        session.recording = DemoRecording(session.flight, folder)
        return {"say": f"Recording into {folder}."}
    return None


def _box(session: Session, message: said.BoxMessage) -> None:
    if isinstance(session.controller, BoxController):
        session.controller.see(message.box, session.size.now)


_ORDERS: dict[type[said.Message], Callable[[Session, Any], dict[str, Any] | None]] = {
    said.KeysMessage: _keys,
    said.LookMessage: _look,
    said.ClickMessage: _click,
    said.DoMessage: _do,
    said.PaceMessage: _pace,
    said.RewardMessage: _reward,
    said.WorldMessage: _world,
    said.FlyMessage: _fly,
    said.DuelMessage: _duel,
    said.FilmMessage: _film,
    said.RecordMessage: _record,
    said.BoxMessage: _box,
}
