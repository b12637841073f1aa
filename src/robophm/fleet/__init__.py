"""Robots that report to one service: what is sent, who sends it, who keeps it, and what is asked of all of them."""
