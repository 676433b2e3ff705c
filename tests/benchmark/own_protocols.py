"""Protocols such as a user writes."""

from eyas import protocol_named

CALM = protocol_named("flown").like(
    "calm", "20 s: as flown, with less wind", {"tracker": {"wind": {"speed": 2.0}}}, episodes=1
)

QUICK = protocol_named("paper").like(
    "quick", "1 s: as paper", {"done": {"total_steps": 500}}, episodes=1
)
