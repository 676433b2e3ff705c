"""The simulation: joins the rooms below, and owns the clock and the step.

May import: `overlay` and all rooms below.
Begin with `simulation.py`, then `stepper.py` and `views`. Private: `eyas` offers what is public.
"""
