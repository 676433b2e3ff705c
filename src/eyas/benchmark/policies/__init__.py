"""Policies that can be evaluated: built in, from files, and a user's own."""
