"""Simulations and pictures on a graphics processor of NVIDIA, to the same bytes.

May import: `engine`, `lanes`.
Begin with `README.md`, then `cuda/device.py` and `sim/simulation.py`.
"""
