"""The demo: a drone that a person flies, in the browser, a window or a terminal."""
