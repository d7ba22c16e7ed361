"""A scene in a cell of a real notebook: Jupyter Lab in a headless Chromium."""

import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image as Picture

import dotray

CELL = """import dotray
scene = dotray.Scene(background=(.2, .3, .5))
balls = scene.add_spheres([[-1, 0, 0], [1, 0, 0]], .8, color=[[.9, .3, .2], [.3, .8, .4]])
scene.look_at((0, 2, 7), (0, 0, 0), half_angle=.3)
scene.add_light(dotray.PointLight((2, 6, 4)))
dotray.jupyter.view(scene, height=420)
"""


def test_what_cannot_be_shown_is_said():
    with pytest.raises(ValueError, match="height is 0"):
        dotray.jupyter.view(dotray.Scene(), height=0)


def test_nothing_large_is_stored_in_the_notebook():
    scene = dotray.Scene()
    scene.add_spheres(np.random.default_rng(1).random((1000, 3)), 0.05)
    state = dotray.jupyter.view(scene).get_state()
    assert state["height"] == 480
    assert sum(len(str(value)) for value in state.values()) < 10_000


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Jupyter Lab with a notebook of one cell; its address."""
    folder = tmp_path_factory.mktemp("lab")
    cell = {"cell_type": "code", "id": "a", "metadata": {}, "source": CELL, "outputs": [], "execution_count": None}
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    notebook = {"cells": [cell], "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}
    (folder / "scene.ipynb").write_text(json.dumps(notebook))
    names = ("JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR", "JUPYTERLAB_SETTINGS_DIR")
    own = {name: str(folder / name) for name in names}
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--ServerApp.port=0", "--ip=127.0.0.1"]
    command += ["--allow-root", "--ServerApp.root_dir=" + str(folder), "--LabApp.news_url=None"]
    command += ["--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate"]
    log = open(folder / "log", "w+")
    with subprocess.Popen(command, cwd=folder, env={**os.environ, **own}, stdout=log, stderr=log) as server:
        try:
            until = time.monotonic() + 90
            while not (found := re.search(r"http://127\.0\.0\.1:\d+/lab\?token=(\w+)", (folder / "log").read_text())):
                assert time.monotonic() < until and server.poll() is None, (folder / "log").read_text()
                time.sleep(0.2)
            base, token = found[0].split("?")[0], found[1]
            yield f"{base}/tree/scene.ipynb?token={token}"
        finally:
            server.terminate()


def run_cell(page):
    """Runs the notebook's cell until it shows a canvas. The lab drops what is to be run while it has no kernel yet."""
    canvas = page.locator(".jp-OutputArea canvas").first
    cell = page.locator(".jp-Notebook .jp-Cell .cm-content").first
    prompt = page.locator(".jp-Notebook .jp-InputArea-prompt").first
    until = time.monotonic() + 240
    while True:
        cell.click(timeout=90_000)
        page.keyboard.press("Control+Enter")
        patience = time.monotonic() + 30
        # A cell that runs, or has run, is not asked again: that would take its canvas away.
        while time.monotonic() < patience or prompt.inner_text() != "[ ]:":
            if canvas.is_visible():
                return canvas
            assert time.monotonic() < until, page.locator(".jp-Cell").all_inner_texts()
            time.sleep(0.2)


def test_a_scene_is_turned_and_traced_in_a_cell(lab):
    playwright = pytest.importorskip("playwright.sync_api")
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if chromium is None:
        pytest.skip("no chromium")
    flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    flags += ["--force-color-profile=srgb", "--disable-dev-shm-usage"]
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=flags, chromium_sandbox=False)
        page = browser.new_page(viewport={"width": 1100, "height": 800})
        page.goto(lab)
        canvas = run_cell(page)

        def wait(name, wanted, seconds=90):
            until = time.monotonic() + seconds
            while not wanted(value := canvas.get_attribute(name) or ""):
                assert time.monotonic() < until, (name, value, page.locator(".jp-OutputArea").all_inner_texts())
                time.sleep(0.1)
            return value

        wait("data-shapes", lambda shapes: shapes == "2")
        wait("data-prepared", lambda prepared: prepared == "true")
        box = canvas.bounding_box()
        middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        camera = wait("data-camera", bool)
        page.mouse.move(*middle)
        page.mouse.down()
        for step in range(1, 6):
            page.mouse.move(middle[0] + 20 * step, middle[1])
            time.sleep(0.1)
        page.mouse.up()
        wait("data-camera", lambda now: now != camera)
        page.keyboard.press("r")
        wait("data-camera", lambda now: now == camera)
        page.keyboard.press("t")
        wait("data-traced", lambda traced: traced == "true")
        x, y, width, height = (round(float(number)) for number in wait("data-view", bool).split())
        page.mouse.move(5, 5)
        time.sleep(1)
        picture = page.screenshot(timeout=150_000)
        box = canvas.bounding_box()
        if folder := os.environ.get("DOTRAY_KEEP"):
            (pathlib.Path(folder) / "jupyter.png").write_bytes(picture)
        browser.close()
    place = {}
    exec(CELL.replace("dotray.jupyter", "#"), place)
    wanted = np.round(place["scene"].render(width, height).numpy().clip(0, 1).astype(float) * 255)
    left, top = round(box["x"]) + x, round(box["y"]) + y
    shown = np.asarray(Picture.open(io.BytesIO(picture)).convert("RGB"))[top : top + height, left : left + width]
    # The very pixels of the library's own picture; the cell may be taller than what of it is in sight.
    assert shown.shape[0] > height / 2 and shown.shape[1] == width
    assert (shown == wanted[: shown.shape[0]]).all(axis=2).mean() > 0.99
