"""People who walk."""
