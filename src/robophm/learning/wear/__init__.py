"""Wear that a sensor sees → remaining life until a threshold.

``averaging.py`` foretells it by all degradation models of ``models/``, averaged; ``wiener_and_gamma.py`` by one of a
straight trend, Brownian motion with drift (Wiener) or gamma; ``trend_bend.py`` tests whether the drift is straight,
``increment_covariance.py`` is what both share, ``cusum.py`` tells changes against a baseline; ``readings_table.py`` and
``signal_to_readings.py`` take readings from tables and from a signal's samples; ``progpy_models.py`` has NASA's models
of batteries and motors.
"""
