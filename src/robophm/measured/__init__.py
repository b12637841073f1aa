"""Inspection of measured data: what recordings hold, and where, for how long and how often.

A signal's value holds from one sample to the next, and at most for a stated time: ``held_values.py``. All else asks the
stretches in which one value holds, block by block, in memory that does not grow with the recordings: ``find.py``,
``statistics.py``, ``levels.py`` (time at level), ``series.py`` (what is drawn), ``profile.py`` (the levels that parts
of a robot lived at, as a load to come). ``overview.py`` says what there is, ``export.py`` writes samples as they are,
``window_table.py`` stretches of time with their figures.
"""
