"""What every room needs: errors, names, configuration, random streams, clock, frames, compilation."""
