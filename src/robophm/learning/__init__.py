"""What the field says of a robot, each kind of record in a room of its own.

``rates/``: failures → rates. ``life_data/``: life data and tests → life distributions. ``wear/``: readings of wear →
remaining life. ``maintenance/``: costs → when to replace what. ``diagnosis/``: alarms → suspects. ``table.py`` reads
the tables that people keep, ``failure_mode_edits.py`` writes into a design what was found; no room imports another.
"""
