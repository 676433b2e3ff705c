"""Recordings of traffic: making them with SUMO, and telling what they hold."""
