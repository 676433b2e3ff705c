"""The protocols by name."""

from collections.abc import Mapping

from eyas.benchmark.protocol import Protocol
from eyas.benchmark.protocols.corrupted import CORRUPTED
from eyas.benchmark.protocols.crowd import CROWD
from eyas.benchmark.protocols.evade import EVADE
from eyas.benchmark.protocols.flown import FLOWN
from eyas.benchmark.protocols.lasting import DISTRACTOR, LONG, SEARCH
from eyas.benchmark.protocols.published import PAPER, STANDARD, UNSEEN
from eyas.benchmark.protocols.recover import RECOVER, RECOVER_CAMERA
from eyas.benchmark.protocols.referring import REFERRING
from eyas.benchmark.protocols.team import PAIR, TEAM
from eyas.engine.core.errors import UnknownNameError

__all__ = ["PROTOCOLS", "protocol_named"]

_ALL = (
    *(PAPER, STANDARD, UNSEEN, CORRUPTED, LONG, SEARCH, DISTRACTOR, FLOWN),
    *(RECOVER, RECOVER_CAMERA, EVADE, REFERRING, CROWD, PAIR, TEAM),
)

PROTOCOLS: Mapping[str, Protocol] = {protocol.name: protocol for protocol in _ALL}


def protocol_named(name: str, place: str = "--protocol") -> Protocol:
    """Return a protocol.

    Args:
        name: Its name.
        place: Option or setting with the name, for the message.

    Raises:
        UnknownNameError: There is no such protocol.
    """
    if name not in PROTOCOLS:
        raise UnknownNameError(place, name, PROTOCOLS)
    return PROTOCOLS[name]
