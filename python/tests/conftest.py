"""What tests share: plans take a second, so they are made once."""

import signal
from pathlib import Path

import pytest

import saltus

# A shell that puts a command into the background has it ignore Ctrl-C, and then Python does not listen either.
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def lateral() -> saltus.Plan:
    return saltus.plan("a1/lateral")


@pytest.fixture(scope="session")
def urdf() -> Path:
    return ROOT / "models/a1.urdf"
