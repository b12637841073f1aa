"""Failures of a log → updated failure rates.

``failure_log.py`` reads a log, ``rate_update.py`` makes of its failures each mode's updated rate, ``gamma_poisson.py``
is the update of one rate, ``fleet.py`` that of robots which differ, ``life_scale.py`` says what rates promise in lives
which are no power of age, and ``evidence.py`` writes what was learned into the design.
"""
