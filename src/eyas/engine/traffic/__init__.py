"""Traffic: road networks from SUMO, recording, smoothing and replay.

May import: `render` and all rooms below.
Begin with `source.py`, then `recording.py`. Private: `eyas` offers what is public.
"""
