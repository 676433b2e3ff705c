"""The task: start poses, rewards, done reasons, direction, packets."""
