"""How many inputs are generated: 300 in all by default, thousands where the profile is free."""

from __future__ import annotations

from hypothesis import HealthCheck, settings

FREE = settings.get_current_profile_name() == "free"


def examples(few: int, many: int) -> settings:
    """Settings of a test: `many` examples in the fuzz tier, else `few`."""
    return settings(max_examples=many if FREE else few, suppress_health_check=list(HealthCheck))
