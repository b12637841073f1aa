"""Structures of parts: block diagrams and fault trees, and their exact evaluation."""
