"""Recordings of what robots said: .bag, .db3 and .mcap, tables in .csv, and journals of live runs.

``opening.py`` says which source reads a file, ``files.py`` what the files of a recording are; ``recording.py`` gives
samples one by one, ``columns/`` many at a time; ``salvage.py`` reads damaged ones, ``paced.py`` plays one as if live.
"""
