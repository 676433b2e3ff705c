"""Who drives where: road networks through SUMO, recording and replay."""
