"""Writers of pictures, films, labels and marks, one for each format.

May import: `sim` and all rooms below.
Begin with `frame.py`, then `writer.py`. Private: `eyas` offers what is public.
"""
