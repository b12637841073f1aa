"""``python -m tests.transports.recordings.columns.fuzz``: damaged recordings, by number, and what is read of them.

A file is made of a sound one by a random generator that is seeded with its number. It is read in a process with a
limit of memory and of time; a process that dies, an error that is none of ours, values that were made up, messages
that are lost without a word and answers that differ from those of rosbags and mcap are findings.
"""
