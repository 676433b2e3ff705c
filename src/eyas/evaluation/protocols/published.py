"""The published test."""

from eyas.evaluation.protocol import Protocol

__all__ = ["PAPER"]

PAPER = Protocol("paper", "the published test: 3 s, figures CR and TSR", rank="cr")
