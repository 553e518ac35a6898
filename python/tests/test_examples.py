"""The examples run at a small size."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_own_record(capsys: pytest.CaptureFixture[str]) -> None:
    """The surface doubles the incident motion, as far as a coarse mesh shows it."""
    ratio = example("own_record").main(8)
    assert 1.5 < ratio < 2.5
    assert "times the incident one" in capsys.readouterr().out


def test_watched_run(capsys: pytest.CaptureFixture[str]) -> None:
    """The run ends when the crown has moved."""
    results = example("watched_run").main(limit=1e-4)
    assert "the crown has moved" in capsys.readouterr().out
    assert results.time < 20.0 and len(results.snapshots) > 0
