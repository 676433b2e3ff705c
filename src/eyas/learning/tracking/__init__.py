"""Teaches the network of the tracker: pictures of flights, labelled by the simulator itself."""
