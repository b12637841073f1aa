"""How parts make a system: block diagrams and their exact evaluation."""
