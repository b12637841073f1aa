"""``python -m robophm`` is the command line."""

from robophm.cli import main

main()
