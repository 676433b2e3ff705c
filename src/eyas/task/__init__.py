"""What is asked: start poses, rewards, done reasons, direction, packets."""
