"""The interface of `import robophm`: the question of each command, asked in Python and answered with objects.

A function has the name of its command and prints nothing; where it asks for a robot, the path of its design will do.
"""
