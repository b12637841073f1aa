"""The formats of recordings. One file here is one format; the file's name is its name.

A format says in ``FORMAT`` how it recognises a file by its first bytes and how it opens one: as a source of samples
(``SampleFormat``), or as a file of messages (``MessageFormat``). Another package adds such a module by an entry point
of the group ``robophm.transports.recordings.formats``. What a format needs to read files is imported when it does.
"""
