"""Colours of road paint by country: of crossings, and of lines between two directions."""

import shapely

from eyas.maps.osm.features import PaintColour

_YELLOW_CROSSINGS = shapely.Polygon([
    (5.95, 46.13), (6.12, 46.57), (6.44, 46.93), (6.86, 47.17), (7.0, 47.5), (7.59, 47.59),
    (8.4, 47.58), (8.57, 47.81), (8.9, 47.65), (9.56, 47.54), (9.53, 47.27), (9.63, 47.05),
    (9.87, 46.93), (10.39, 46.99), (10.49, 46.62), (10.05, 46.22), (9.95, 46.38), (9.28, 46.5),
    (9.25, 46.23), (9.02, 45.82), (8.78, 46.09), (8.45, 46.46), (8.1, 46.13), (7.86, 45.92),
    (7.04, 45.93), (6.79, 46.14), (6.81, 46.43), (6.3, 46.4), (6.31, 46.22),
])  # fmt: skip
"""Switzerland and Liechtenstein, to a few kilometres, by the Swiss rules of signs, article 77."""

_YELLOW_MIDDLES = shapely.MultiPolygon([
    # The Americas without Greenland, by the manuals that follow the MUTCD, section 3B.01
    shapely.Polygon([(-170, 72), (-170, 15), (-110, -60), (-30, -60), (-30, 15),
                     (-50, 50), (-62, 72)]),
    # Mainland China, by GB 5768.3
    shapely.Polygon([(74, 40), (80, 31), (86, 28.2), (97, 28.2), (98.5, 22), (102, 21.2),
                     (106.5, 22.5), (108, 18), (111.5, 18.5), (113.5, 22.215), (114.6, 22.6),
                     (118.5, 24.3), (122.5, 30), (121, 35), (124.3, 40), (131, 43), (135, 48.3),
                     (126, 52), (119, 50), (116, 46.5), (111, 43.5), (97, 42.6), (88, 48),
                     (80, 45)]),
    # The Republic of Korea
    shapely.Polygon([(126, 37.7), (125, 34), (126, 33), (129.8, 35), (129.6, 38.3), (128, 38.3)]),
])  # fmt: skip
"""Where the line between the two directions of a road is yellow."""


def usual_paint(longitude: float, latitude: float) -> tuple[PaintColour, PaintColour]:
    """Return the colours of crossings and of lines between directions at a place, in degrees."""
    x = (longitude + 180.0) % 360.0 - 180.0
    return (
        "yellow" if shapely.contains_xy(_YELLOW_CROSSINGS, x, latitude) else "white",
        "yellow" if shapely.contains_xy(_YELLOW_MIDDLES, x, latitude) else "white",
    )
