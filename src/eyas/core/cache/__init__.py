"""What Eyas keeps on disk from run to run, in one folder with one limit."""
