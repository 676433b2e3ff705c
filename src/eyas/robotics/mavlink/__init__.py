"""MAVLink: each tracker as a vehicle that ground stations and programs of the field can fly.

May import: `sim` and all rooms below; not `exports`, not `wire`.
Begin with `fleet.py`. Frames are converted in `frames.py` only; pymavlink is imported in
`dialect.py` only. Private: nothing is public.
"""
