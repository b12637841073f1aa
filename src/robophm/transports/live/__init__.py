"""What live transports share: ``receiving.py`` gives messages their time, ``decoding.py`` makes numbers of them."""
