"""robophm with ROS. It runs in a Python of its own, since robots have older ones; this here runs in the robot's."""
