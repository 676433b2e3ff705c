"""Simulations whose state lies on a device: the step, near lists, poses and cameras there."""

__all__: list[str] = []
