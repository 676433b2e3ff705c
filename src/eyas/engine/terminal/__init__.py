"""What a user can run, a file or folder each; `api.py` offers the same to Python.

The gallery and the benchmark are modes, not tools of the house: users look at maps of their own,
and measure their own machines.

May import: all rooms but `cli`.
Begin with `video/run.py`. Private: `eyas` offers what is public.
"""
