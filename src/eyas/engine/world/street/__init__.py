"""Street furniture: signals, lamps, benches, car parks and parked cars."""
