"""Points that keep a distance from each other."""

from eyas.lanes import exact


class SpacedPoints:
    """Points that keep a distance; a new one is compared only with those in the squares around it.

    Args:
        apart: Least distance between two points [m].
    """

    def __init__(self, apart: float) -> None:
        self.points: list[tuple[float, float]] = []
        self._apart = apart
        self._side = 1.001 * apart  # slightly larger, so that rounding hides no neighbour
        self._squares: dict[tuple[int, int], list[tuple[float, float]]] = {}

    def add(self, x: float, y: float) -> bool:
        """Add a point if no other is near; return whether it was added."""
        column, row = int(x // self._side), int(y // self._side)
        for i in (column - 1, column, column + 1):
            for j in (row - 1, row, row + 1):
                for east, north in self._squares.get((i, j), ()):
                    if exact.hypot(east - x, north - y) <= self._apart:
                        return False
        self.points.append((x, y))
        self._squares.setdefault((column, row), []).append((x, y))
        return True
