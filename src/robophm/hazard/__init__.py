"""Hazard rates: models of what makes parts fail, handbooks, accelerations."""
