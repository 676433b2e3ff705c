"""A card of NVIDIA that is not there: a driver that runs programs in PTX on this processor.

It runs what a card would get: the shipped PTX, with its warps of threads, votes, shuffles and
memory that threads share, and refuses memory that is not the card's. It is slow, and counts what is
done.
"""

from emulated_card.card import EmulatedCard, Loaded, driver_library, emulated_card

__all__ = ["EmulatedCard", "Loaded", "driver_library", "emulated_card"]
