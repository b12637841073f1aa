"""Access to the service: the roles of those who use it, and what is kept of users, sessions and changes."""
