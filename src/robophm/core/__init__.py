"""The ground floor, which imports nothing of robophm: errors, units, tables, signals, the plug registry."""
