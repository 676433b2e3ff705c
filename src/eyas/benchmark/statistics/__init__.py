"""Statistics: figures of a sample of episodes with 95 % intervals, and paired differences.

Begin with `intervals.py`.
"""
