"""What every room needs: errors, names, settings, random streams, clock, frames, compilation."""
