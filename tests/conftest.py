"""Settings shared by all tests.

Warnings are errors (pyproject.toml), so NumPy's division by zero, overflow and invalid operations are too.
"""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "default", deadline=None, derandomize=True, max_examples=60, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("default")
