"""What tests share: plans take a second, so they are made once."""

from pathlib import Path

import pytest

import saltus

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def lateral() -> saltus.Plan:
    return saltus.plan("a1/lateral")


@pytest.fixture(scope="session")
def urdf() -> Path:
    return ROOT / "models/a1.urdf"
