"""How hazard depends on age. One file here is one life distribution; the file's name is its name in a design."""
