"""Packages that only some tests need."""

import importlib.util
import os

import pytest


def packages(*names):
    """Skips the module that asks without these, or fails where SHROUDS_REQUIRE_ALL is set."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if missing:
        message = f"not installed: {', '.join(missing)} (python/tests/requirements-distributed.txt)"
        if os.environ.get("SHROUDS_REQUIRE_ALL"):
            raise ImportError(message)
        pytest.skip(message, allow_module_level=True)
