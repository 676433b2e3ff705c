"""Episodes: what one is, how a batch of them starts, and which ones a protocol chooses.

Begin with `episode.py` and `episode_batch.py`; each other file is one rule of choice.
"""
