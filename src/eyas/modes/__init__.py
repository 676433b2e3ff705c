"""The modes that a user can run, one file or folder each."""
