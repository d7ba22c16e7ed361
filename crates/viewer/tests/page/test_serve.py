"""`rayview --serve`: the page from the program, with the tracing done there."""

import http.client
import os
import re
import subprocess
import time

import pytest
from conftest import HEAVY, NOTES, SCENE, Moves, Viewer, judge, pixels, rendered


@pytest.fixture
def served(scene):
    """The program, and the address that it prints."""
    command = [os.environ["RAYVIEW"], "--serve", scene / "shapes.ray"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        found = re.search(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", program.stdout.readline())
        yield found[0], int(found[1]), found[2]
        program.kill()


@pytest.fixture
def viewer(browser, served):
    viewer = Viewer(browser, served[0])
    yield viewer
    viewer.close()


def test_a_scene_is_shown_and_traced_by_the_program(viewer, served, scene):
    viewer.wait("data-shapes", "3")
    traced = viewer.trace()
    wanted = rendered(scene, "shapes.ray", viewer.view()[2:])
    assert (traced == pixels(wanted)).all()
    with viewer.page.expect_download() as download:
        viewer.page.keyboard.press("Control+s")
    assert open(download.value.path(), "rb").read() == wanted
    viewer.click(*viewer.at(0.36, 0.45))
    viewer.wait("data-rays", lambda rays: rays != "0")
    assert viewer.get("data-selected") == "sphere 1 · shapes.ray:13"
    assert all(url.startswith(served[0]) for _, url in viewer.requests if not url.startswith("blob:"))
    # The tracing was the program's: the page has no tracer of its own.
    assert not any(url.endswith("tracer.js") for _, url in viewer.requests)


def test_the_page_follows_the_file(viewer, scene):
    viewer.wait("data-prepared", "true")
    file = scene / "shapes.ray"
    file.write_text(SCENE.replace("-1.2 .9 0  1", "-1.2 .9 wide  1"))
    assert "shapes.ray:13" in viewer.wait("data-messages", bool)
    assert viewer.get("data-shapes") == "3"
    file.write_text(SCENE + "#shape_sphere 1  0 2 0  .4\n")
    viewer.wait("data-shapes", "4")
    viewer.wait("data-messages", "")
    assert (viewer.trace() == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()


def test_the_camera_is_written_into_the_file(viewer, scene):
    viewer.wait("data-prepared", "true")
    camera = viewer.get("data-camera")
    viewer.drag(viewer.at(0.5, 0.5), viewer.at(0.7, 0.5))
    viewer.wait("data-camera", lambda now: now != camera)
    for x in range(460, 640, 20):
        viewer.click(x, 12)
        if "written" in viewer.get("data-notice"):
            break
    assert "shapes.ray" in viewer.wait("data-notice", lambda notice: "written" in notice)
    until = time.monotonic() + 20
    while (written := (scene / "shapes.ray").read_text()) == SCENE and time.monotonic() < until:
        time.sleep(0.1)
    old, new = SCENE.splitlines(), written.splitlines()
    assert [a == b for a, b in zip(old, new)].count(False) == 1 and len(old) == len(new)
    assert new[1].startswith("#camera") and new[1] != old[1]


def test_a_move_is_heard_soon(browser, scene):
    """From the hand in the browser until the program has stopped tracing the old picture."""
    (scene / "heavy.ray").write_text(HEAVY)
    command = [os.environ["RAYVIEW"], "--serve", scene / "heavy.ray"]
    environment = {**os.environ, "RAYVIEW_HEARD": str(scene / "heard")}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as program:
        address = re.search(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", program.stdout.readline())[0]
        viewer = Viewer(browser, address, size=(800, 450), prepare=lambda page: page.add_init_script(NOTES))
        viewer.wait("data-prepared", "true")
        viewer.page.keyboard.press("t")
        time.sleep(4)
        moves = Moves(viewer.page, viewer.at)
        assert viewer.get("data-traced") == "false"
        viewer.close()
        program.kill()
    heard = [int(line) / 1000 for line in (scene / "heard").read_text().split()]
    judge(moves, moves.waits(lambda when: next(each for each in heard if each >= when)))


def ask(served, path, **headers):
    """The status and the text of a request with these headers alone."""
    connection = http.client.HTTPConnection("127.0.0.1", served[1], timeout=10)
    connection.putrequest("GET", path, skip_host=True, skip_accept_encoding=True)
    for name, value in headers.items():
        connection.putheader(name.replace("_", "-"), value)
    connection.endheaders()
    response = connection.getresponse()
    return response.status, response.read()


def test_strangers_are_refused(served):
    address, port, token = served
    own = f"127.0.0.1:{port}"
    assert ask(served, f"/{token}/", Host=own)[0] == 200
    # No token, another one, another host, another origin.
    assert ask(served, "/", Host=own)[0] == 403
    assert ask(served, f"/{token[::-1]}/", Host=own)[0] == 403
    assert ask(served, f"/{token}/", Host=f"evil.example:{port}")[0] == 403
    assert ask(served, f"/{token}/", Host=own, Origin="http://evil.example")[0] == 403
    # Nothing but the page's own files.
    for path in ["../../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "/etc/passwd", "shapes.ray", "index.html/x"]:
        assert ask(served, f"/{token}/{path}", Host=own)[0] == 404
    socket = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec_WebSocket_Version": "13"}
    socket["Sec_WebSocket_Key"] = "dGhlIHNhbXBsZSBub25jZQ=="
    assert ask(served, f"/{token}/socket", Host=own, **socket)[0] == 403
    assert ask(served, f"/{token}/socket", Host=own, Origin="http://evil.example", **socket)[0] == 403
    assert ask(served, "/x/socket", Host=own, Origin=f"http://{own}", **socket)[0] == 403


def test_a_page_of_another_origin_gets_nothing(browser, served, site):
    context = browser.new_context()
    page = context.new_page()
    page.goto(site + "page.css")
    address = served[0]
    fetched = page.evaluate("(address) => fetch(address).then(() => 'had', () => 'refused')", address)
    opened = page.evaluate(
        """(address) => new Promise((done) => {
            const socket = new WebSocket(address.replace("http", "ws") + "socket");
            socket.onopen = () => done("had");
            socket.onerror = () => done("refused");
        })""",
        address,
    )
    assert (fetched, opened) == ("refused", "refused")
    context.close()


def test_rubbish_ends_the_session_and_nothing_else(viewer, served):
    viewer.wait("data-prepared", "true")
    closed = viewer.page.evaluate(
        """(address) => new Promise((done) => {
            const socket = new WebSocket(address.replace("http", "ws") + "socket");
            socket.onopen = () => socket.send(new Uint8Array([0, 250, 255, 255, 255, 255]));
            socket.onclose = () => done("closed");
        })""",
        served[0],
    )
    assert closed == "closed"
    viewer.trace()
