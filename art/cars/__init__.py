"""Bodies and wheels of cars from one grammar, of those in traffic and of those that are parked."""
