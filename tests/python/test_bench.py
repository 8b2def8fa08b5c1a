"""The machinery behind `cargo xtask bench`."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "xtask/python"))

import bench  # noqa: E402


class Fake:
    """Answers with what it was asked and how many questions came before, of all its kind."""

    asked = 0

    def ask(self, request):
        Fake.asked += 1
        return {"request": request, "turn": Fake.asked}


def test_contenders_take_turns():
    first, later = bench.alternate([(Fake(), "a"), (Fake(), "b")], 3)
    assert [answer["turn"] for answer in first] == [1, 2]
    assert [[answer["turn"] for answer in answers] for answers in later] == [[3, 5, 7], [4, 6, 8]]
    assert {answer["request"] for answer in later[1]} == {"b"}


def test_a_table_takes_the_place_of_the_old_one(tmp_path):
    document = tmp_path / "document.md"
    parts = "above\n<!-- bench one -->\n{}<!-- /bench one -->\nbelow\n"
    parts += "<!-- bench two -->\nkept\n<!-- /bench two -->\n"
    document.write_text(parts.format("old\nolder\n"))
    assert bench.rewrite(document, "one", ["new", "newer"])
    assert document.read_text() == parts.format("new\nnewer\n")
    assert not bench.rewrite(document, "three", ["lost"])
    assert [path.name for path in tmp_path.iterdir()] == ["document.md"]


def test_the_document_has_a_place_for_every_table():
    text = (ROOT / "docs/benchmarks.md").read_text()
    marks = re.findall(r"<!-- bench (\S+) -->\n.*?<!-- /bench \1 -->", text, re.DOTALL)
    names = ["speed", "stages", "midpoint", "threads", "program"]
    large = [f"{name}-large" for name in names]
    accuracy = ["growth", "accuracy-primal", "accuracy-dual"]
    parts = ["size", "labels", "speed", "geometry", "planes-speed", "meshes"]
    compression = [f"compression-{part}" for part in parts]
    assert sorted(marks) == sorted([*names, *large, *accuracy, *compression])


def test_a_worker_that_stops_is_named():
    with bench.Worker(sys.executable, "-c", "input()") as worker:
        with pytest.raises(SystemExit, match="failed at run: .*input"):
            worker.ask("run")
