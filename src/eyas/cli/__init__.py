"""The command line: parses, calls a mode, prints errors in one line.

May import: everything below; each command imports its mode when it runs.
Begin with `app.py`, then the file of a command. Private: `eyas` offers what is public.
"""
