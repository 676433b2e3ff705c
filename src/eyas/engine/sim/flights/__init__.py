"""Camera flights of recordings: paths as a pilot would fly them, planned before they are flown.

May import: the rooms below `sim`, and `sim` itself.
"""
