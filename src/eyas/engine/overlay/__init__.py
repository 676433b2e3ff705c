"""Marks on finished pictures: the view of a camera, the rewarded area, the target.

May import: `task` and all rooms below.
Begin with `marks.py`. Private: `eyas` offers what is public.
"""
