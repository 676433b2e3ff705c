"""Protocols: the settings in which all policies fly, one file each, and the table of their names.

A user's own is a `Protocol` in another package, best made by `Protocol.like` of one of these.

Begin with `protocol.py`, then `published.py` and `table.py`.
"""
