"""The mesh kit: what maps, vehicles and overlays are modelled with."""
