"""Tools for modelling the meshes of maps, vehicles and overlays."""
