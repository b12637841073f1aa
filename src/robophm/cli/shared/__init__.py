"""What several commands share: options, and how they read, print and write."""
