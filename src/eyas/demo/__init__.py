"""The demo: a drone that a person flies, in the browser or a terminal."""
