"""What a server is about: free flight, or the flights of a protocol that are recorded."""

import json
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from eyas.benchmark.plan.plan import EvaluationPlan
from eyas.benchmark.protocols.table import PROTOCOLS
from eyas.demo import messages as said
from eyas.demo.flight_thread import Audience, FlightThread
from eyas.demo.offer import BOXES, words_of
from eyas.demo.orders import reward_of, world_now
from eyas.demo.reference import ReferenceThread, plan_for
from eyas.demo.session import Session
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.installed import installed_version
from eyas.engine.settings.dialect import spoken
from eyas.engine.world.maps import MAPS

File = tuple[str, bytes]  # Its type, and its bytes


class Flying(Protocol):
    """What flies, in a thread of its own."""

    def put(self, message: said.Message) -> None:
        """Take what the pilot says; may be called in any thread."""
        ...

    def stop(self) -> None:
        """End `run`; may be called in any thread."""
        ...

    def run(self) -> None:
        """Fly."""
        ...


class Stage(Protocol):
    """What pages see and pilots do."""

    page: str
    """Path of the page that is shown at `/`."""
    hears_acks: bool
    """Whether what flies is told when the pilot's page has shown a frame."""

    def flying(self, audience: Audience) -> Flying:
        """Return what flies for an audience."""
        ...

    def greeting(self) -> dict[str, Any]:
        """Return what a page must know to begin."""
        ...

    def file(self, path: str) -> File | None:
        """Return what is made on request; None: nothing.

        Raises:
            ConfigError: It cannot be made.
        """
        ...

    def other(self, protocol: str | None) -> "Stage":
        """Return the stage of the flights of a protocol; None: the one before this.

        Raises:
            EyasError: There is no such stage.
        """
        ...

    def after(self) -> "Stage | None":
        """Return the stage when this one is over; None: the demo ends."""
        ...


class FreeStage:
    """A session of free flight."""

    page, hears_acks = "/index.html", False

    def __init__(self, session: Session) -> None:
        self._session, self.news = session, ""

    def flying(self, audience: Audience) -> Flying:
        """Return what flies the session."""
        return FlightThread(self._session, audience)

    def greeting(self) -> dict[str, Any]:
        """Return the choices of the menus."""
        offer = self._session.offer = self._session.find_offer()
        told: dict[str, Any] = {
            "hello": installed_version(),
            "maps": {
                name: {"title": title, "weathers": MAPS.get(name).weathers}
                for name, title in offer.maps.items()
            },
            "policies": {**offer.policies, BOXES: "your own program sees the target"},
            "protocols": _flown_by_one(),
            "most_vehicles": self._session.flight.config.traffic.max_vehicles,
            "targets": {name: words_of(name) for name in offer.targets},
            "lights": list(said.LIGHTS),
        }
        news, self.news = self.news, ""
        told |= {"say": news} if news else {}
        return told | reward_of(self._session) | world_now(self._session)

    def other(self, protocol: str | None) -> Stage:
        """Return the stage of a protocol's flights, in `runs/people-PROTOCOL`."""
        if protocol not in (known := _flown_by_one()):
            raise UnknownNameError("protocol", str(protocol), tuple(known))
        folder = Path("runs") / f"people-{protocol}"
        return ReferenceStage(plan_for(str(protocol), folder), before=self)

    def after(self) -> Stage | None:
        """Return nothing: free flight is over when the demo is."""
        return None

    def file(self, path: str) -> File | None:
        """Return `/map.json` or `/env_config.json`.

        Raises:
            ConfigError: The original's keys cannot express the settings.
        """
        if path == "/map.json":
            return "application/json", json.dumps(self._streets()).encode()
        if path == "/env_config.json":
            text = json.dumps(spoken(path).content_of(self._session.flight.config), indent=4)
            return "application/json", f"{text}\n".encode()
        return None

    def _streets(self) -> dict[str, Any]:
        """Return the middle lines of all lanes [m], and the width of each."""
        network = self._session.flight.world.assets.scene.network
        lanes = np.split(np.round(network.lane_points, 1), network.lane_first[1:-1])
        return {
            "lanes": [lane.tolist() for lane in lanes],
            "widths": np.round(network.lane_width, 1).tolist(),
        }


def _flown_by_one() -> dict[str, str]:
    """Return the titles of the protocols that a person can fly."""
    rules = {name: PROTOCOLS.get(name) for name in PROTOCOLS.built_in}
    return {name: each.title for name, each in rules.items() if not each.team}


class ReferenceStage:
    """The flights of people in a protocol."""

    page, hears_acks = "/reference.html", True

    def __init__(self, plan: EvaluationPlan, before: FreeStage | None = None) -> None:
        self._plan, self._before = plan, before

    def flying(self, audience: Audience) -> Flying:
        """Return what flies the protocol's episodes."""
        self._thread = ReferenceThread(self._plan, audience)
        return self._thread

    def greeting(self) -> dict[str, Any]:
        """Return which flight is next."""
        told: dict[str, Any] = {"hello": installed_version(), "protocol": self._plan.protocol}
        told |= {"title": self._plan.rules.title, "back": self._before is not None}
        return told | {"reference": self._thread.stage}

    def file(self, path: str) -> File | None:
        """Return nothing: a person sees what a policy sees, no map and no truth."""
        return None

    def other(self, protocol: str | None) -> Stage:
        """Return the free flight from which people came here."""
        if self._before is None or protocol is not None:
            raise ConfigError("stage: these flights only, as the demo was started for them")
        return self._before

    def after(self) -> Stage | None:
        """Return the free flight, which then says where the flights are; None without one."""
        if self._before is not None:
            folder = Path(self._plan.policy).parent
            self._before.news = f"All flights are recorded, in {folder}."
        return self._before
