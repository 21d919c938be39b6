"""Settings for all tests: Hypothesis profiles with a printed seed, and the marker `slow`.

`pytest` runs the profile `ci` (the same examples every time) without the slow tests.
`HYPOTHESIS_PROFILE=dev` looks for new examples, with the seed printed in the header; `pytest
--slow` runs everything.
"""

from __future__ import annotations

import os
import secrets

import pytest
from hypothesis import HealthCheck, settings

pytest_plugins = ["pytester"]

settings.register_profile(
    "ci",
    derandomize=True,
    deadline=None,
    max_examples=50,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.register_profile("dev", settings.get_profile("ci"), derandomize=False, max_examples=100)
settings.register_profile("long", settings.get_profile("dev"), max_examples=2000)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="run the tests marked slow too")


def pytest_configure(config: pytest.Config) -> None:
    profile = os.environ.get("HYPOTHESIS_PROFILE", "ci")
    settings.load_profile(profile)
    if (
        not settings.get_profile(profile).derandomize
        and config.getoption("hypothesis_seed", None) is None
    ):
        config.option.hypothesis_seed = str(secrets.randbelow(10**9))


def pytest_report_header(config: pytest.Config) -> str:
    seed = config.getoption("hypothesis_seed", None)
    how = "derandomized" if seed is None else f"repeat with --hypothesis-seed={seed}"
    profile = settings.get_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))
    return f"hypothesis examples: {profile.max_examples} ({how})"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--slow"):
        return
    skip = pytest.mark.skip(reason="slow: run with --slow")
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(skip)
