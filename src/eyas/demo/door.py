"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=False,
    brings={
        "eyas.commands": {"demo": "eyas.demo.commands:demo", "replay": "eyas.demo.commands:replay"}
    },
)
