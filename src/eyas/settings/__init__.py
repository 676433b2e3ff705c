"""All settings of a run: their root, and how they are read, written and checked."""
