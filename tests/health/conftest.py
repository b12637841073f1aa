from hypothesis import settings

# Derandomised and without a database of examples: the same tests everywhere, every time.
settings.register_profile("robophm-health", derandomize=True, database=None, deadline=None, max_examples=40)
settings.load_profile("robophm-health")
