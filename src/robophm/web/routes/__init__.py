"""What can be asked of the service, by subject: the ``router`` of each file here is found by itself.

Another package adds such a module by an entry point of the group ``robophm.web.routes``.
"""
