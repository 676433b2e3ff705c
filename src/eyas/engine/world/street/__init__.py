"""Street furniture that moves or signals: traffic lights, bicycles."""
