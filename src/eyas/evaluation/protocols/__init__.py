"""The protocols by name."""

from collections.abc import Mapping

from eyas.core.errors import UnknownNameError
from eyas.evaluation.protocol import Protocol
from eyas.evaluation.protocols.corrupted import CORRUPTED
from eyas.evaluation.protocols.crowd import CROWD
from eyas.evaluation.protocols.evade import EVADE
from eyas.evaluation.protocols.flown import FLOWN
from eyas.evaluation.protocols.lasting import DISTRACTOR, LONG, SEARCH
from eyas.evaluation.protocols.published import PAPER, STANDARD, UNSEEN
from eyas.evaluation.protocols.recover import RECOVER, RECOVER_CAMERA
from eyas.evaluation.protocols.referring import REFERRING
from eyas.evaluation.protocols.team import PAIR, TEAM

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
