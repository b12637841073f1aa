"""Options that several commands share, and how they read, print and write."""
