"""The library of robot parts: what they fail by, with the source of every figure and how good that is.

An entry is a component as a design file has it, with what it rests on. Its files, ``library/<kind>.yaml``, are data;
somebody else's package adds its own by an entry point of the group ``robophm.parts`` that names a package with such
files. A design takes an entry by ``part: lidar_2d``.
"""

from __future__ import annotations

from robophm.parts.completing import completed
from robophm.parts.entries import FIGURES, GRADES, Entry, graded, library
from robophm.parts.searching import part, search

__all__ = ["FIGURES", "GRADES", "Entry", "completed", "graded", "library", "part", "search"]
