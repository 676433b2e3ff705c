"""What follows: the drone and its gimbal."""
