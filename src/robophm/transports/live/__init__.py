"""The common base of live transports: ``receiving.py`` gives messages their time, ``decoding.py`` makes numbers of
them.
"""
