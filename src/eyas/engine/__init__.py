"""The engine: state, world, render, sensors, trackers, targets, traffic, simulation, environments.

May import: `lanes`, and no other house; its rooms are layers, in the order of `README.md`.
Begin with `README.md`, then `envs/tracking_env.py`, `sim/simulation.py`, `sim/step.py`.
"""
