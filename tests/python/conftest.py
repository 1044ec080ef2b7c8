"""What several test files share."""

from __future__ import annotations

import pytest
from browser import Browser


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    """A headless Chromium."""
    running = Browser(tmp_path_factory.mktemp("chromium"))
    yield running
    running.close()
