"""The protocol of the original: a server for its clients, over files and UDP.

May import: `sim` and all rooms below; not `exports`.
Begin with `server.py`. Private: `eyas` offers what is public.
"""
