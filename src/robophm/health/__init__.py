"""The robot as lived: exposure from its sensors, and what follows from it."""
