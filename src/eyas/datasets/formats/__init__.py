"""The formats, one family a file."""
