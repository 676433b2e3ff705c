"""Recordings as bags of ROS 2, without ROS; docs/ros.md."""
