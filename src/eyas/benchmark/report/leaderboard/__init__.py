"""Evaluations of many in one page, and those of others flown again."""
