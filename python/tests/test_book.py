"""The snippets of the book's page run, in their order, in one program."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "book" / "src" / "python.md"


def test_every_snippet_of_the_book_runs(tmp_path: Path) -> None:
    if importlib.util.find_spec("cloudpickle") is None:
        pytest.skip("the page's learner is defined in a script, which takes cloudpickle")
    snippets = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(snippets) >= 6
    (tmp_path / "page.py").write_text("\n".join(snippets), encoding="utf-8")
    told = subprocess.run([sys.executable, "page.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    assert "`furlong` is no unit" in told.stdout
    assert "Damped" in told.stdout and "sindy" in told.stdout
    assert (tmp_path / "gap.html").exists()
