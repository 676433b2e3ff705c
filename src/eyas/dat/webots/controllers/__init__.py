"""Controllers of the project: programs of their own, which Webots starts with its own Python.

They import nothing but each other and the standard library; `project.py` copies them into the
folders of those that use them, where they import each other by their bare names.
"""
