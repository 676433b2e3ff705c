"""The program `eyas`: commands of all houses, errors in one line, exit codes.

May import: everything below; each command imports what it runs when it runs.
Begin with `README.md`, then `main.py` and `app.py`.
"""
