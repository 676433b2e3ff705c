"""What follows: the drone, supervised and flown, the car, and the interface of a tracker.

May import: `custom` and all rooms below.
Begin with `tracker.py`, then `drone.py`. Private: `eyas` offers what is public.
"""
