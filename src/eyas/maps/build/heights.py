"""Heights that all parts of a flat map share."""

FLOOR_HEIGHT = -0.1
"""z of the lawn, on which buildings, trees and poles stand; as in the original [m]."""

KERB_HEIGHT = 0.15  # z of the pavements [m]
