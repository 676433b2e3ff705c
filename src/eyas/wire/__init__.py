"""The protocol of the original: a server for its clients, over files and UDP."""
