"""The task: start poses, rewards, contacts, the end, the direction of the target, packets.

May import: `sensors` and all rooms below.
Begin with `reward.py`, then `done.py`. Private: `eyas` offers what is public.
"""
