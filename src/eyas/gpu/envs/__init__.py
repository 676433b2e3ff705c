"""Environments whose observations, rewards and ends are arrays on a device."""

__all__: list[str] = []
