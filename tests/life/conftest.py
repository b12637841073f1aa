from hypothesis import settings
from tests.cases import examples

# Derandomised and without a database of examples: the same tests everywhere, every time.
settings.register_profile("robophm-life", derandomize=True, database=None, deadline=None, max_examples=examples(60))
settings.load_profile("robophm-life")
