"""What the tracker measures."""
