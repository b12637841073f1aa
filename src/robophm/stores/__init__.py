"""Stores of a robot's past: its exposure ledger and the history of its reports.

One file here is one store; the file's name is its name. A store keeps a ledger, the progress of replays and new
reports in one step: after a crash all of it is there, or none.
"""
