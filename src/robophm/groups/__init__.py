"""Parts whose lives depend on each other, standby and load sharing: exact, and by chance as an independent check."""
