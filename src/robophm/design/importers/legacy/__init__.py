"""The tool of 2020: its files become designs, and its figures are kept beside ours.

``reading.py`` reads a file, ``blocks.py`` is what one describes and what is odd in it, ``writing.py`` makes the text of
a design; ``figures.py`` has that tool's own figures, faults included.
"""
