"""The demo: a drone that a person flies, in the browser or a terminal.

May import: `eyas.engine`, `eyas.lanes`, `eyas.benchmark`, for policies that fly too.
Begin with `README.md`, then `run.py` and `flight_thread.py`.
"""
