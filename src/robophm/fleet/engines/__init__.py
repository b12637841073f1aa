"""Engines that keep the tables of a fleet: one file each, with one class derived from ``Engine``."""
