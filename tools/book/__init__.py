"""The documentation as a site: pages of the repository, and a reference made of the code, built without a network."""
