"""A tracker that is shown its target once: a detector, a memory of which one, and a filter."""
