"""Curves for TensorBoard."""

from collections.abc import Mapping
from pathlib import Path

__all__ = ["Board"]


class Board:
    """Writes numbers for TensorBoard, if it is installed.

    Args:
        folder: Where its files are.
    """

    def __init__(self, folder: Path) -> None:
        try:
            from torch.utils.tensorboard import SummaryWriter
        except ImportError:  # curve.csv has the same
            self._writer = None
        else:
            self._writer = SummaryWriter
        self._folder = folder

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve."""
        if self._writer is None:
            return
        with self._writer(str(self._folder), purge_step=decisions) as writer:
            for name, value in values.items():
                if name != "decisions":
                    writer.add_scalar(name, value, decisions)
