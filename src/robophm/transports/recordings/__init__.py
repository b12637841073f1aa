"""Recordings of what robots said, tables, and journals of live runs.

``formats/`` has a plug for each format, ``format.py`` their interface; ``recognising.py`` says of which format a file
is, ``opening.py`` which source reads it, ``files.py`` what the files of a recording are. ``recording.py`` gives samples
one by one, ``columns/`` many at a time, ``looking.py`` those of any format; ``logged.py`` is what logs of autopilots
have in common; ``salvage.py`` reads damaged ones, ``paced.py`` plays one as if live.
"""
