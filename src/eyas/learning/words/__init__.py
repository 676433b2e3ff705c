"""Teaches the network of the listener: pictures of dressed traffic, labelled by the simulator."""
