"""The commands of `eyas maps`: `app.py` has their options, the other files what they do."""
