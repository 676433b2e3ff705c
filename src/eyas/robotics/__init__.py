"""Programs of the field: MAVLink, PX4 and ArduPilot, ROS 2, and fitting a drone to its flights.

May import: `eyas.engine`, `eyas.lanes`.
Begin with `README.md`, then `serving/mavlink.py` and `mavlink/fleet.py`.
"""
