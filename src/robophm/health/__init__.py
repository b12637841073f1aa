"""The health of a robot: exposure from its sensors, and what follows from it."""
