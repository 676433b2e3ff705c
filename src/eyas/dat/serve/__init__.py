"""Serving clients of the original."""
