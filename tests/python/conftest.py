"""Fixtures for the tests that run the program: set CLEARWAY_BIN to the binary to test."""

import os
from pathlib import Path

import pytest

from clearway_cli import Clearway


@pytest.fixture(scope="session")
def clearway() -> Clearway:
    """The program under test. A missing binary fails the test; nothing is skipped."""
    path = os.environ.get("CLEARWAY_BIN")
    if not path:
        pytest.fail("set CLEARWAY_BIN to the clearway binary, e.g. target/release/clearway", False)
    binary = Path(path).resolve()
    if not os.access(binary, os.X_OK):
        pytest.fail(f"CLEARWAY_BIN is {path}, which is no executable file", False)
    return Clearway(binary)
