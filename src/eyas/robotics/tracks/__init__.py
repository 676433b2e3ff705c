"""Tracks of others: phones and receivers, odometry, logs of flight controllers, missions."""
