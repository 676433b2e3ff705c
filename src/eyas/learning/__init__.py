"""Networks learn to follow a target: by rewards, by a teacher, or by pictures with truth.

May import: `benchmark`, `engine`, `lanes`; all but settings and commands imports PyTorch.
Begin with `README.md`, then `trainer.py` and `algorithm.py`.
"""
