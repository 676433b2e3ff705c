"""Identity of code: what a build is, and of which definitions a function is made.

Begin with `program.py`, then `definitions.py`, `build.py`.
"""
