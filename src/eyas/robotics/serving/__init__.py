"""What `eyas serve` runs with --mavlink, --px4, --ardupilot and --ros: checks, then a loop.

Each file builds one face of `eyas.engine.sim.serving`, the loop that all of them share.
"""
