"""Learning from the field: failures → rates, life data → distributions, wear → remaining life, costs → maintenance.

``rates/``: logs of failures → updated rates. ``life_data/``: lives and tests → life distributions. ``wear/``: readings
of wear → remaining life. ``maintenance/``: costs → when to replace what. ``diagnosis/``: alarms → suspects. No room
imports another; ``table.py`` reads the tables that people keep, ``failure_mode_edits.py`` writes into a design.
"""
