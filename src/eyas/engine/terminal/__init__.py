"""What programs of a terminal share: options, progress, lines on stderr, signals that end them.

May import: `settings` and all rooms below.
Begin with `options.py`, then `interrupts.py`.
"""
