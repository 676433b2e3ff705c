"""A truck without a trailer."""

from art.vehicles.heavy import truck

MODEL = truck(
    "TruckSimple", mass=7500.0, words=("a {} truck", "a {} truck without a trailer"), wheelbase=5.25
)
