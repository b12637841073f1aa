"""Routes of the service, a file for each subject, whose ``router`` is found by itself.

Another package adds such a module by an entry point of the group ``robophm.web.routes``.
"""
