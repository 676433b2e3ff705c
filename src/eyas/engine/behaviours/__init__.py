"""Motion off the traffic: pedestrians and robots that walk and drive by themselves.

May import: `targets` and all rooms below.
Begin with `scripted.py`. Private: `eyas` offers what is public.
"""
