"""Records of progress: the same ones from a function's call and from the program's lines, as docs/progress.md says."""

import json
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

import dotray

PAGE = ROOT / "docs/progress.md"
PROGRAM = Path(os.environ.get("DOTRAY", str(ROOT / "target/release/dotray")))
TYPES = {
    "whole number": lambda value: type(value) is int and value >= 0,
    "number": lambda value: isinstance(value, (int, float)),
    "number or null": lambda value: value is None or isinstance(value, (int, float)),
    "text": lambda value: isinstance(value, str),
}


def described():
    """The keys of each event with their types, from the page's second table."""
    rows = [line.split("|")[1:-1] for line in PAGE.read_text().splitlines() if line.startswith("| `")]
    events = [re.findall("`(.*?)`", row[0])[0] for row in rows if len(row) == 2]
    keys = {event: {} for event in events}
    for row in rows:
        if len(row) == 4:
            of = events if row[1].strip() == "all" else re.findall("`(.*?)`", row[1])
            for event in of:
                keys[event].update({key: row[2].strip() for key in re.findall("`(.*?)`", row[0])})
    assert len(keys) == 7
    return keys


def validate(record):
    keys = described()[record["event"]]
    assert set(record) == set(keys), record
    for key, kind in keys.items():
        known = TYPES.get(kind)
        if known is None:
            assert record[key] in re.findall("`(.*?)`", kind), record
        else:
            assert known(record[key]), (key, record)


def balls():
    scene = dotray.Scene()
    scene.add_spheres(np.random.default_rng(0).random((1000, 3)), 0.03)
    return scene


@pytest.fixture
def start(tmp_path):
    if not PROGRAM.exists():
        pytest.skip("no target/release/dotray")
    balls().save(tmp_path / "balls.ray")

    def run(line, **more):
        words = [PROGRAM, *line.split(), "--progress", "json"]
        return subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, **more)

    return run


def test_functions_get_records_as_the_page_says():
    told = []
    balls().render(200, 150, aa=2, layers=["st"], progress=told.append)
    with ThreadPoolExecutor(2) as executor:
        balls().render(200, 150, executor=executor, progress=told.append)
    assert {record["event"] for record in told} == {"picture", "layers", "progress"}
    for record in told:
        validate(record)
    assert told[-1]["finished_pixels"] == told[-1]["total_pixels"] == 30000


@pytest.mark.parametrize("text", [True, False])
def test_a_program_is_followed(start, text):
    told = []
    with start("render balls.ray a.png --aa grid=3 --layers depth", text=text) as process:
        last = dotray.follow(process, progress=told.append)
    assert (last["outcome"], last["exit"]) == ("done", 0) and told[-1] == last
    assert [told[0]["event"], told[0]["command"], told[1]["event"]] == ["start", "render", "picture"]
    for record in told:
        validate(record)
    # What the program tells and what the package tells are one thing.
    mine = []
    balls().render(640, 480, aa=3, layers=["depth"], progress=mine.append)
    for event in ("picture", "layers", "progress"):
        here, there = (next(it for it in some if it["event"] == event) for some in (mine, told))
        assert list(here) == list(there)
        fixed = ("event", "width", "height", "tiles", "total_pixels")
        assert [here.get(key) for key in fixed] == [there.get(key) for key in fixed]


def test_a_program_that_fails_or_is_killed(start, capsys):
    (last,) = [dotray.follow(start("render nowhere.ray a.png"))]
    assert (last["outcome"], last["exit"]) == ("failed", 1)
    assert "nowhere.ray" in capsys.readouterr().err, "messages go on to people"
    process = start("render balls.ray a.png --size 4000x3000 --aa grid=9")

    def kill(record):
        if record["event"] == "progress":
            process.kill()

    begun = time.monotonic()
    with pytest.raises(EOFError, match="exit code -9"):
        dotray.follow(process, progress=kill)
    assert time.monotonic() - begun < 20
    (last,) = [dotray.follow(start("render balls.ray a.png --size 4000x3000 --aa grid=9 --time-limit 300ms"))]
    assert (last["outcome"], last["exit"]) == ("time-limit", 4)


@pytest.mark.parametrize("with_tqdm", [True, False])
def test_a_bar_follows(start, capsys, monkeypatch, with_tqdm):
    if not with_tqdm:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    dotray.follow(start("render balls.ray a.png --layers st"), progress=True)
    said = capsys.readouterr().err
    assert "dotray: 100" in said or "100%" in said, said
    dotray.follow(start("render balls.ray a.png"))
    assert capsys.readouterr().err == "", "nobody looks"


def test_readers_ignore_what_they_do_not_know(capsys):
    lines = [
        {"event": "start", "seconds": 0, "schema": 1, "mood": "good"},
        {"event": "supper", "seconds": 0.5},
        {"level": "WARN", "fields": {"message": "a warning"}},
        {"event": "end", "seconds": 1, "outcome": "done", "exit": 0, "more": [1]},
    ]
    told = []
    texts = [json.dumps(line) + "\n" for line in lines] + ["{no json\n", "for people\n"]
    last = dotray.follow(texts, progress=told.append)
    assert last["more"] == [1] and [record["event"] for record in told] == ["start", "supper", "end"]
    said = capsys.readouterr().err
    assert "a warning" in said and "{no json" in said and "for people" in said
    assert dotray.follow([text.encode() for text in texts], progress=False)["exit"] == 0
    capsys.readouterr()


def test_what_cannot_be_followed_is_told():
    for schema in (0, 2):
        with pytest.raises(ValueError, match=f"schema {schema}; this version of dotray reads 1"):
            dotray.follow([f'{{"event": "start", "seconds": 0, "schema": {schema}}}'])
    with pytest.raises(EOFError, match="--progress json"):
        dotray.follow([])
    with pytest.raises(ValueError, match="expected a process"):
        dotray.follow("a.log")
    with subprocess.Popen(["true"]) as process, pytest.raises(ValueError, match="stderr=PIPE"):
        dotray.follow(process)


def test_the_examples_of_the_page(start, tmp_path, monkeypatch, capsys):
    """The blocks of Python in docs/progress.md, one after the other, with the program on the path."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "room.ray").write_bytes((tmp_path / "balls.ray").read_bytes())
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/dotray").symlink_to(PROGRAM)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=":")
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    assert len(blocks) >= 2
    names = {}
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    assert (tmp_path / "room.png").exists()
