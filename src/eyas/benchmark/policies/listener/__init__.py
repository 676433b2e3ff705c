"""A tracker that is told its target in words: a detector of vehicles, tracks, and a judge."""
