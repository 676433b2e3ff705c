"""Learning: proximal policy optimisation with a small convolutional network.

The room is the extra `train`: all of it but `config` imports PyTorch.
"""
