"""The cache on disk, kept from run to run in one folder with one size limit."""
