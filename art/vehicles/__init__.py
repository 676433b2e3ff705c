"""Vehicles that drive in traffic: a file for each in `models`. Begin with `vehicle.py`."""
