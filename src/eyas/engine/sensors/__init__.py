"""What trackers sense: lidar, GPS, inertial sensors, their errors, and what rays may hit.

May import: `camera` and all rooms below.
Begin with `config.py`, then `readings.py`. Private: `eyas` offers what is public.
"""
