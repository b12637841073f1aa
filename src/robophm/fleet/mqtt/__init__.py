"""A robot's payloads over MQTT 5: one connection (``connection.py``), the robot's way (``post.py``), the service's."""
