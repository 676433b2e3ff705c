"""Recording of labelled pictures and films: how trackers move, what is drawn, where it is written.

May import: `recordings` and all rooms below.
Begin with `run.py`, then `action.py`, `recorder.py`, `folder.py`.
"""
