"""Codecs of pictures and films: own PNG and deflate, whose bytes are promised; JPEG; PyAV."""
