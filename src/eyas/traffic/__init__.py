"""Traffic: road networks from SUMO, recording and replay."""
