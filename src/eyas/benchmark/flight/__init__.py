"""Flights: a policy flies a batch of episodes, a meter measures, a scenario adds its own figures.

Begin with `batch_flight.py` and `meter.py`; `policy_runner.py` flies batches here or on Ray.
"""
