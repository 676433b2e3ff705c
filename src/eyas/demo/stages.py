"""What a server is about: free flight, or the flights of a protocol that are recorded."""

import json
from typing import Any, Protocol

import numpy as np

from eyas.benchmark.plan.plan import EvaluationPlan
from eyas.demo import messages as said
from eyas.demo.flight_thread import Audience, FlightThread
from eyas.demo.orders import BOXES, reward_of, world_now
from eyas.demo.reference import ReferenceThread
from eyas.demo.session import Session
from eyas.engine.core.installed import installed_version
from eyas.engine.settings.dialect import spoken
from eyas.engine.targets.config import TargetName
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


class FreeStage:
    """A session of free flight."""

    page, hears_acks = "/index.html", False

    def __init__(self, session: Session) -> None:
        self._session = session

    def flying(self, audience: Audience) -> Flying:
        """Return what flies the session."""
        return FlightThread(self._session, audience)

    def greeting(self) -> dict[str, Any]:
        """Return the choices of the menus."""
        maps = {}
        for name in sorted(MAPS.names()):
            recipe = MAPS.get(name)
            maps[name] = {"title": recipe.title, "weathers": recipe.weathers}
        told = {
            "hello": installed_version(),
            "maps": maps,
            "policies": [*self._session.policies, BOXES],
            "most_vehicles": self._session.flight.config.traffic.max_vehicles,
            "targets": [name.value for name in TargetName],
            "lights": list(said.LIGHTS),
        }
        return told | reward_of(self._session) | world_now(self._session)

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


class ReferenceStage:
    """The flights of people in a protocol."""

    page, hears_acks = "/reference.html", True

    def __init__(self, plan: EvaluationPlan) -> None:
        self._plan = plan

    def flying(self, audience: Audience) -> Flying:
        """Return what flies the protocol's episodes."""
        self._thread = ReferenceThread(self._plan, audience)
        return self._thread

    def greeting(self) -> dict[str, Any]:
        """Return which flight is next."""
        told = {"hello": installed_version(), "protocol": self._plan.protocol}
        return told | {"title": self._plan.rules.title, "reference": self._thread.stage}

    def file(self, path: str) -> File | None:
        """Return nothing: a person sees what a policy sees, no map and no truth."""
        return None
