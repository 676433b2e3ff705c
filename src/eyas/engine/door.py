"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(results=True)
