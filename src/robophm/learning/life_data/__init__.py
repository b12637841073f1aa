"""Life data → life distributions, by SurPyval.

``observed_lives.py`` has times to failure with all censoring and stresses, ``fate_words.py`` the words of other tools'
tables, ``failure_modes.py`` parts that fail in several ways, ``limited_failures.py`` those of which some never do,
``distribution_fitting.py`` fits and
compares distributions, ``life_stress.py`` fits accelerated tests (Arrhenius, inverse power, steps),
``repairable_systems.py`` the power law of repaired systems (Crow–AMSAA), ``fit_in_design.py`` says a fit as a design
does, ``surpyval.py`` loads the library.
"""
