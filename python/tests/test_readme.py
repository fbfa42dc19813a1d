"""The program of the package's page runs as it stands there."""

import pytest
from conftest import ROOT


def test_the_program_to_copy_runs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(ROOT)
    page = (ROOT / "python/README.md").read_text()
    (program,) = (part.split("```")[0] for part in page.split("```python\n")[1:])
    names: dict = {}
    exec(compile(program, "README.md", "exec"), names)
    assert names["machine"].phase == "Hold"
    assert names["command"].q.shape == names["torques"].shape == (12,)
