"""What trackers sense: camera errors, lidar, inertial sensors, and what rays may hit.

May import: `trackers` and all rooms below.
Begin with `config.py`, then `readings.py`. Private: `eyas` offers what is public.
"""
