"""Sensors and their alarms → which part it is.

``coverage_matrix.py`` reads which sensors see which failures, ``fault_isolation.py`` gives the chance of each suspect
under the alarms that are on, ``sensor_choice.py`` says which sensors would tell most.
"""
