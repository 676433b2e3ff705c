"""Roads: networks, their areas in plan view, curves."""
