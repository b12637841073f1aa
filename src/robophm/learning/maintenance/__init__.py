"""Costs and lives → when to replace what, and how many spares to keep.

``replacement_age.py`` finds the best age of a part, alone or together with others, ``costs_table.py`` reads what upkeep
costs, ``life_cycle_costs.py`` simulates a robot's life under a policy, ``standstill.py`` says when it stands still
meanwhile, ``spares.py`` how many spares meet the demand. ``upkeep.py`` plans all of it for the parts of a robot.
"""
