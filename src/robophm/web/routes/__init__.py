"""Routes of the service, a file for each subject, whose ``router`` is found by itself.

A route that changes anything declares the role that it needs, by ``@needs("operator")`` right above its function; one
that only looks is for viewers. Another package adds such a module by an entry point of the group
``robophm.web.routes``.
"""
