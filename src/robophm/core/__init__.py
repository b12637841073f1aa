"""The ground floor: errors, units, tables, signals, the plug registry. It imports nothing of robophm."""
