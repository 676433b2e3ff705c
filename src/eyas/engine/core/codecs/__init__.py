"""Codecs of pictures: PNG and deflate of our own, whose bytes are promised; JPEG; films by PyAV.

Begin with `png.py`.
"""
