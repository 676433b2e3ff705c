"""Phrases that tell a target from the others in view, generated from the truth.

`in_view.py` holds what a camera has in view, `claims.py` what a phrase says of it and what fits,
`wording.py` the English, `attributes.py` the same in numbers, `naming.py` chooses what is said.
"""
