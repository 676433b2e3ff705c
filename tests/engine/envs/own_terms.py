"""Terms of the reward such as users write."""

import numpy as np


def height(snapshot):
    return snapshot.trackers.position[:, 2] * 0.01


def fails_after_two_steps(snapshot):
    if snapshot.episodes.step_count.max() > 8:
        raise ValueError("no such\nthing")
    return np.zeros(len(snapshot.episodes.step_count))
