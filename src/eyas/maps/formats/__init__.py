"""A map, or a flight over it, in files of other programs: a file here for each format.

`registry.py` holds the formats of `eyas maps export`; `gltf/flight.py` and `openscenario.py` are
writers of flights, which the door brings. `meshes.py` gives the parts of a map that all need.
"""
