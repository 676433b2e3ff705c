"""Encoders of pictures: PNG and deflate of our own, whose bytes are promised; JPEG; PyAV for films.

Begin with `png.py`.
"""
