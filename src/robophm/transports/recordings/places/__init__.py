"""Places where recordings lie that are no files of this machine. One file here is one kind of place.

A place says in ``PLACE`` which schemes of addresses are its own, and how a file there is opened (``Place``). Another
package adds such a module by an entry point of the group ``robophm.transports.recordings.places``.
"""
