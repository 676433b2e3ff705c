"""Records: one line of JSON for each flown episode, and the files of an evaluation's folder.

Begin with `record.py`.
"""
