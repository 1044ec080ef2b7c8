"""The guides in docs/: every block that is marked runs, in one folder a page, and every link leads somewhere.

A block's fence says what becomes of it: `python run` is run after the page's earlier ones; `yaml NAME` is
written to that file; `sh run` holds calls of `tope`; `python pink` and `python tsid` run in the environments
of `make peers`, if they are there; `cpp FILE` must stand in that file as it is. Not here: the prose.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from tope.cli import main

ROOT = Path(__file__).parents[2]
FENCE = re.compile(r"^```(\w+) ([\w./-]+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")
PAGES = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md", ROOT / "examples/README.md"]
GUIDES = [page for page in PAGES if FENCE.search(page.read_text(encoding="utf-8"))]
PEERS = ("pink", "tsid")


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """Language, mark and text of each marked block."""
    return FENCE.findall(page.read_text(encoding="utf-8"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Where a page's blocks run: robots/ and scenarios/ beside what they write."""
    for name in ("robots", "scenarios"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def call_tope(line: str) -> None:
    program, *arguments = shlex.split(line)
    assert program == "tope", f"not a call of tope: {line}"
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert not ended.value.code, f"{line}: {ended.value.code}"


def test_the_guides_are_found():
    assert {page.name for page in GUIDES} >= {"your-robot.md", "which-method.md", "moving-from.md", "ros2.md"}


@pytest.mark.parametrize("page", GUIDES, ids=lambda page: page.name)
def test_marked_blocks_run(page, folder):
    names: dict[str, object] = {}
    for language, mark, text in blocks(page):
        if (language, mark) == ("python", "run"):
            exec(compile(text, f"{page.name}, block", "exec"), names)
        elif (language, mark) == ("sh", "run"):
            for line in text.splitlines():
                call_tope(line)
        elif language == "yaml":
            (folder / mark).write_text(text, encoding="utf-8")
        elif language == "cpp":
            assert text in (ROOT / mark).read_text(encoding="utf-8"), f"{mark} has no such lines:\n{text}"
        else:
            assert (language, mark) in {("python", peer) for peer in PEERS}


@pytest.mark.parametrize("peer", PEERS)
def test_blocks_for_other_libraries_run(peer, folder):
    interpreter = ROOT / ".venv-peers" / peer / "bin/python"
    if not interpreter.exists():
        pytest.skip(f"{peer} is not installed: make peers PEERS={peer}")
    texts = [text for page in GUIDES for _, mark, text in blocks(page) if mark == peer]
    assert texts
    ours = ("PYTHONPATH", "LD_LIBRARY_PATH")  # their packages are not those of the tests
    environment = {key: value for key, value in os.environ.items() if key not in ours}
    for text in texts:
        subprocess.run([interpreter, "-c", text], check=True, cwd=folder, env=environment, timeout=120)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), f"{page.name}: {target}"
