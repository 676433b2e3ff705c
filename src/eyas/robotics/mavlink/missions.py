"""Answers to those who want to send a mission: there is none, and none can be taken."""

from typing import Any

from eyas.robotics.mavlink.component import Component

__all__ = ["refuse_missions"]

_ACCEPTED, _UNSUPPORTED, _BAD_NUMBER = 0, 3, 13
_ALL = 255


def refuse_missions(component: Component) -> None:
    """Let a component answer MAVLink's mission protocol."""

    def to(message: Any) -> dict[str, int]:  # noqa: ANN401  # pymavlink's
        return {
            "target_system": message.get_srcSystem(),
            "target_component": message.get_srcComponent(),
            "mission_type": min(getattr(message, "mission_type", 0), _ALL),
        }

    def answer(kind: int) -> Any:  # noqa: ANN401  # a function of a message
        return lambda message: component.send("mission_ack", type=kind, **to(message))

    def tell_count(message: Any) -> None:  # noqa: ANN401  # pymavlink's
        component.send("mission_count", count=0, **to(message))

    component.heard.update(
        {
            "MISSION_REQUEST_LIST": tell_count,
            "MISSION_CLEAR_ALL": answer(_ACCEPTED),
            "MISSION_COUNT": answer(_UNSUPPORTED),
            "MISSION_WRITE_PARTIAL_LIST": answer(_UNSUPPORTED),
            **{
                kind: answer(_BAD_NUMBER)
                for kind in ("MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_SET_CURRENT")
            },
        }
    )
