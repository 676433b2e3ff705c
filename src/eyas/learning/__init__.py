"""A small convolutional network is taught by a teacher or by rewards; the extra `train`.

May import: `evaluation` and all rooms below; all but `config` imports PyTorch.
Begin with `trainer.py`. Private: `eyas` offers what is public.
"""
