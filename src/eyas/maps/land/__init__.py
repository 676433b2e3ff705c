"""The ground: lawn, asphalt and pavements, and the land beyond the map."""
