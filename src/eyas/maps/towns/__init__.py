"""Towns of which only some is known, such as imported ones: the rest is what usually is there."""
