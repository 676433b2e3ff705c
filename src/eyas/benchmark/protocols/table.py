"""The protocols by name: one file and one line in this table each.

A user's own is a `Protocol` in another package, best made by `Protocol.like` of one of these. It is
found by its path (`my_package.rules:WINDY`) or by the name of an entry point in the group
`eyas.protocols`.
"""

from eyas.benchmark.protocols.protocol import Protocol
from eyas.engine.core.errors import UnknownNameError
from eyas.engine.core.registry import OWN, Registry

_ROOM = "eyas.benchmark.protocols"

PROTOCOLS: Registry[Protocol] = Registry(
    "--protocol",
    Protocol,
    {
        "paper": f"{_ROOM}.published:PAPER",
        "standard": f"{_ROOM}.published:STANDARD",
        "unseen": f"{_ROOM}.published:UNSEEN",
        "corrupted": f"{_ROOM}.corrupted:CORRUPTED",
        "long": f"{_ROOM}.lasting:LONG",
        "long-10": f"{_ROOM}.lasting:LONG_TEN",
        "gimbal": f"{_ROOM}.lasting:GIMBAL",
        "search": f"{_ROOM}.lasting:SEARCH",
        "distractor": f"{_ROOM}.lasting:DISTRACTOR",
        "flown": f"{_ROOM}.flown:FLOWN",
        "recover": f"{_ROOM}.recover:RECOVER",
        "recover-camera": f"{_ROOM}.recover:RECOVER_CAMERA",
        "recover-wide": f"{_ROOM}.recover:RECOVER_WIDE",
        "evade": f"{_ROOM}.evade:EVADE",
        "pursuit": f"{_ROOM}.pursuit:PURSUIT",
        "referring": f"{_ROOM}.referring:REFERRING",
        "mission": f"{_ROOM}.mission:MISSION",
        "air": f"{_ROOM}.air:AIR",
        "crowd": f"{_ROOM}.crowd:CROWD",
        "coat": f"{_ROOM}.crowd:COAT",
        "pair": f"{_ROOM}.team:PAIR",
        "team": f"{_ROOM}.team:TEAM",
    },
    group="eyas.protocols",
)


def protocol_named(name: str, place: str = "--protocol") -> Protocol:
    """Return a protocol.

    Args:
        name: Its name or path.
        place: Option or setting with the name, for the message.

    Raises:
        UnknownNameError: There is no such protocol.
        ConfigError: There is no such path, or something else is there.
    """
    try:
        return PROTOCOLS.get(name)
    except UnknownNameError:
        raise UnknownNameError(place, name, PROTOCOLS.names(), others=OWN) from None
