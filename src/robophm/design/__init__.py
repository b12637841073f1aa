"""The robot as designed: modules, components, failure modes, wiring, sensors; and the file that says so."""
