"""Wear that a sensor sees → remaining life until a threshold.

``averaging.py`` foretells it by all degradation models of ``models/``, averaged; ``trend_bend.py`` tests whether the
trend so far is straight, by ``increment_covariance.py``; ``cusum.py`` tells changes against a baseline;
``worn_mode.py`` puts these together for a failure mode, with readings from tables (``readings_table.py``) or from a
signal's samples (``signal_to_readings.py``); ``progpy_models.py`` has NASA's models of batteries and motors.
"""
