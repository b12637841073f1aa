"""The fleet's page: which robots fail first, by design and site, and each robot's past; HTML without any script."""
