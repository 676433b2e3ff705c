"""Settings of the server for the original's protocol."""

from typing import Annotated

from pydantic import Field

from eyas.engine.settings.section import Section


class WireConfig(Section):
    """Settings of `eyas serve`, the server for the original's protocol."""

    section = "wire"

    address: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Network address to listen on; `0.0.0.0` lets other machines announce agents."""
    port: Annotated[int, Field(ge=1, le=65535)] = 38711
    """UDP port on which the number of trackers is announced."""
    reward_packet: bool = True
    """Whether the custom reward packet is sent."""
    patience: Annotated[float, Field(gt=0, le=1e6)] = 30.0
    """Time after which a client that does not go on is reported [s]; it is waited for all the
    same, and a new client can take its place."""
