"""The plan of an evaluation: what is flown, the class of its entry, and the latency.

Begin with `plan.py`.
"""
