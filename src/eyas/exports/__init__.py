"""Writers of frames, labels and videos."""
