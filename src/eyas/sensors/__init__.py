"""Sensors of the tracker."""
