"""Importing, describing, drawing and exporting maps."""
