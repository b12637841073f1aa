"""Files of other tools become designs: ``bom/`` parts lists, ``open_psa/`` fault trees, ``legacy/`` the 2020 tool's,
``urdf/`` descriptions of robots.

Each reads a file by its path and gives a design as text, which reads as a robot without an error; it writes nothing.
What is not a file of its kind it refuses with a DesignError of one line that names the file.
"""
