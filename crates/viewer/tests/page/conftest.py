"""What the tests of the page share: a browser, the page's files on a server, and a hand that knows the page.

The environment names the programs: CHROMIUM, DOTRAY and RAYVIEW; `run.sh` sets them.
"""

import functools
import http.server
import io
import os
import pathlib
import shutil
import subprocess
import threading
import time

import numpy
import PIL.Image
import pytest
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).parents[4]
DIST = ROOT / "crates/viewer/web/dist"

SCENE = """// a scene of a few shapes
#camera 0 1.2 7  0 -.12 -1  0 1 0  .38
#background .2 .3 .5
#ambient .5 .5 .5
#light_point .6 .6 .5  2 6 4  1 0 .01
#light_dir .3 .3 .3  -1 -1 -1
#texture_num 1
#texture cells.png
#material_num 2
#material .3 .3 .3  .7 .7 .7  .3 .3 .3  0 0 0  .2 0 1  0 !textured!
#material .2 .1 .1  .8 .3 .2  .6 .6 .6  0 0 0  .5 0 1  -1 !mirror!
#shape_box 0  0 -.3 0  6 .4 5
#shape_sphere 1  -1.2 .9 0  1
#shape_cylinder 0  1.3 .6 .3  .6 1.4
"""


def cells():
    """A texture."""
    rows = [[(230, 200, 60), (60, 100, 200), (200, 80, 80)][(x + y) % 3] for y in range(8) for x in range(8)]
    image = PIL.Image.new("RGB", (8, 8))
    image.putdata(rows)
    out = io.BytesIO()
    image.save(out, "PNG")
    return out.getvalue()


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Apart(Quiet):
    """Parts its pages from all others, which may then share memory with their threads."""

    def end_headers(self):
        self.send_header("Cross-Origin-Opener-Policy", "same-origin")
        self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
        super().end_headers()


def served_by(handler):
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(handler, directory=DIST))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()


@pytest.fixture(scope="session")
def site():
    """The page's files, as any server for files has them."""
    yield from served_by(Quiet)


@pytest.fixture(scope="session")
def apart():
    """The same from a server that lets pages share memory."""
    yield from served_by(Apart)


@pytest.fixture(scope="session")
def playwright():
    with sync_playwright() as playwright:
        yield playwright


def launched(playwright, *more, display=None):
    """A Chromium that draws by software, with these flags; on a display, where one is named."""
    flags = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    flags += ["--force-color-profile=srgb", "--disable-dev-shm-usage", *more]
    path = os.environ["CHROMIUM"]
    screen = {"headless": False, "env": {**os.environ, "DISPLAY": display}} if display else {}
    return playwright.chromium.launch(executable_path=path, args=flags, chromium_sandbox=False, **screen)


@pytest.fixture
def display():
    """A display of its own, without a hand."""
    lacking = [program for program in ("Xvfb", "xdotool", "import") if shutil.which(program) is None]
    if lacking:
        pytest.skip(f"no {lacking[0]}")
    command = ["Xvfb", "-displayfd", "1", "-screen", "0", "1400x900x24", "-nolisten", "tcp", "-noreset"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        yield f":{server.stdout.readline().strip()}"
        server.terminate()


@pytest.fixture(scope="session")
def browser(playwright):
    browser = launched(playwright)
    yield browser
    browser.close()


def rendered(folder, name, size, *more):
    """What `dotray render` makes of a scene: the bytes of its file."""
    out = folder / f"rendered-{size[0]}x{size[1]}.png"
    command = [os.environ["DOTRAY"], "render", folder / name, out, *map(str, size), *more]
    subprocess.run(command, check=True, capture_output=True)
    return out.read_bytes()


def pixels(png):
    return numpy.asarray(PIL.Image.open(io.BytesIO(png)).convert("RGB"))


class Viewer:
    """A page with the viewer on it, and a hand."""

    def __init__(self, browser, address, scale=1, size=(1100, 640), prepare=lambda page: None):
        # A dense screen is the browser's: where a page is only told of one, its canvas has too few pixels.
        viewport = {"width": size[0], "height": size[1]}
        screen = {"viewport": viewport} if scale == 1 else {"no_viewport": True}
        self.context = browser.new_context(color_scheme="dark", **screen)
        self.scale = scale
        self.page = self.context.new_page()
        self.requests, self.faults = [], []
        self.page.on("request", lambda request: self.requests.append((request.method, request.url)))
        self.page.on("pageerror", lambda fault: self.faults.append(str(fault)))
        prepare(self.page)
        self.page.goto(address)
        self.wait("data-view", bool)

    def get(self, name):
        return self.page.locator("canvas").get_attribute(name) or ""

    def wait(self, name, wanted, seconds=60):
        """Waits until an attribute of the canvas is so."""
        until = time.monotonic() + seconds
        while True:
            value = self.get(name)
            if wanted(value) if callable(wanted) else value == wanted:
                return value
            if time.monotonic() > until:
                said = self.page.locator("#message").inner_text()
                pytest.fail(f"{name} is {value!r} after {seconds} s; {said!r} {self.get('aria-label')!r} {self.faults}")
            time.sleep(0.05)

    def drop(self, files):
        """Drops files on the page, as a hand does."""
        files = [{"name": name, "bytes": list(content)} for name, content in files.items()]
        transfer = self.page.evaluate_handle(
            """(files) => {
                const transfer = new DataTransfer();
                for (const file of files) transfer.items.add(new File([new Uint8Array(file.bytes)], file.name));
                return transfer;
            }""",
            files,
        )
        self.page.dispatch_event("canvas", "dragover", {"dataTransfer": transfer})
        self.page.dispatch_event("canvas", "drop", {"dataTransfer": transfer})

    def view(self):
        """The view's place in points, and its size in pixels."""
        x, y, width, height = self.wait("data-view", bool).split()
        return float(x), float(y), int(width), int(height)

    def at(self, across, down):
        """A place in points of a part of the view."""
        x, y, width, height = self.view()
        return x + width / self.scale * across, y + height / self.scale * down

    def shot(self):
        """The view's pixels; the pointer is put where it shows nothing."""
        self.page.mouse.move(*self.page.evaluate("[innerWidth - 5, innerHeight - 5]"))
        time.sleep(0.5)
        x, y, width, height = self.view()
        clip = {"x": x, "y": y, "width": width / self.scale, "height": height / self.scale}
        return pixels(self.page.screenshot(clip=clip, scale="device"))

    def drag(self, start, end):
        self.page.mouse.move(*start)
        self.page.mouse.down()
        for step in range(1, 6):
            self.page.mouse.move(*[a + (b - a) * step / 5 for a, b in zip(start, end)])
            time.sleep(0.1)
        self.page.mouse.up()

    def click(self, x, y):
        # A press and its release in one frame of the screen would be no click.
        self.page.mouse.move(x, y)
        time.sleep(0.3)
        self.page.mouse.down()
        time.sleep(0.2)
        self.page.mouse.up()

    def trace(self):
        """Switches to the traced picture and waits for its end."""
        self.wait("data-prepared", "true")
        if self.get("data-mode") != "traced":
            self.page.keyboard.press("t")
        self.wait("data-traced", "true", seconds=120)
        return self.shot()

    def close(self):
        self.context.close()


# Mirrors and glass among each other under lamps of many points: a few rays take longer than a move may wait.
LAMPS = "\n".join(f"#light_area .1 .1 .1 {x} 9 6 -.1 -1 -.6 2 1 0 0" for x in range(-12, 12))
BALLS = [f"#shape_sphere 2 {x * 0.5} {y * 0.5} {(x * x + 3 * y) % 4} .24\n" for x in range(-9, 9) for y in range(-4, 9)]
HEAVY = SCENE.replace("#light_dir .3 .3 .3  -1 -1 -1", LAMPS).replace("#texture_num 1\n#texture cells.png\n", "")
HEAVY = HEAVY.replace("  0 !textured!", "  -1 !plain!").replace("#material_num 2", "#material_num 3")
HEAVY += "#material .1 .1 .1 .4 .4 .4 .5 .5 .5 0 0 0 .9 .9 1.5 -1 !glass!\n" + "".join(BALLS)

# Notes when a hand has done something, and when a page's tracers are told something that cannot wait.
NOTES = """
    globalThis.deeds = [];
    for (const name of ["wheel", "pointermove", "keydown"]) {
        addEventListener(name, ({ buttons, repeat, timeStamp }) => {
            if (buttons !== 0 && !repeat || name === "wheel") deeds.push([name, performance.timeOrigin + timeStamp]);
        }, { capture: true });
    }
    globalThis.sent = {};
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (data, ...more) {
        if (data.turn) sent[data.turn] ??= performance.timeOrigin + performance.now();
        return post.call(this, data, ...more);
    };
"""
# Notes in a tracer when it hears of it: it then traces nothing.
HEARD = """() => {
    globalThis.heard = {};
    addEventListener("message", ({ data }) => {
        if (data.turn) heard[data.turn] ??= performance.timeOrigin + performance.now();
    });
}"""


def ticks():
    """The clock ticks of all programs, of this one with its children, and of none."""
    numbers = [int(number) for number in pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:]]
    processes = {}
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        processes[int(folder.name)] = int(fields[1]), sum(int(field) for field in fields[11:15])
    family = [os.getpid()]
    for parent in family:
        family += [number for number, (of, _) in processes.items() if of == parent]
    own = sum(processes[number][1] for number in family if number in processes)
    return sum(numbers[:3]) + sum(numbers[5:7]), own, sum(numbers[3:5])


class Moves:
    """Moves over a picture that is traced, and how long each tracer has gone on after them, in milliseconds."""

    def __init__(self, page, at):
        """`at` says where in the page a part of the view is."""
        # The key that began to trace is no move.
        page.evaluate("deeds.length = 0")
        before = ticks()
        for turn in range(60):
            x, y = at(0.35 + 0.005 * turn, 0.5)
            page.mouse.move(x, y)
            time.sleep(0.15)
            if turn % 3 == 0:
                page.mouse.wheel(0, 40 if turn % 2 else -40)
            elif turn % 3 == 1:
                page.mouse.down()
                time.sleep(0.25)
                page.mouse.move(x + 14, y + 3)
                time.sleep(0.3)
                page.mouse.up()
            else:
                key = "ArrowLeft" if turn % 2 else "ArrowRight"
                page.keyboard.down(key)
                time.sleep(0.2)
                page.keyboard.up(key)
            time.sleep(0.45)
        everyone, own, idle = (after - before for after, before in zip(ticks(), before))
        self.others = max(everyone - own, 0) / max(everyone + idle, 1)
        # What follows one move at once belongs to it.
        self.deeds, last = [], 0
        for name, when in page.evaluate("deeds"):
            if when > last + 250:
                self.deeds.append((name, when))
            last = when

    def waits(self, heard):
        """`heard(when)` is when all tracers had heard of a move."""
        waits = {}
        for name, when in self.deeds:
            waits.setdefault(name, []).append(heard(when) - when)
        for name, each in waits.items():
            print(f"{name}: {len(each)} waits in ms, half {quantile(each, 0.5):.0f}, 95 % {quantile(each, 0.95):.0f}")
        every = [wait for each in waits.values() for wait in each]
        print(f"half {quantile(every, 0.5):.0f}, 95 % {quantile(every, 0.95):.0f}, all {max(every):.0f}")
        print(f"other programs had {self.others:.2f} of the machine")
        return waits

    def by_workers(self, page):
        """The waits of a page with tracers of its own."""
        sent = sorted((when, int(turn)) for turn, when in page.evaluate("sent").items())
        each = [{int(turn): when for turn, when in worker.evaluate("heard").items()} for worker in page.workers]

        def heard(when):
            turn = next((turn for at, turn in sent if at >= when), None)
            assert turn is not None, "a move was never told"
            return max(min(at for later, at in one.items() if later >= turn) for one in each)

        return self.waits(heard)


def judge(moves, waits):
    """Browsers hand turns of the wheel out with their next frame alone, which comes late where all is drawn by software
    and a frame is under way. And nobody can promise anything where other programs want the cores."""
    every = [wait for name, each in waits.items() if name != "wheel" for wait in each]
    assert len(every) >= 30 and len(waits["wheel"]) >= 10
    if moves.others < 0.1:
        assert quantile(every, 0.95) <= 50, waits
        assert quantile(waits["wheel"], 0.5) <= 250, waits
    else:
        assert quantile(every, 0.5) < 500, waits


def quantile(waits, part):
    return sorted(waits)[min(int(len(waits) * part), len(waits) - 1)]


@pytest.fixture
def scene(tmp_path):
    """A folder with the scene and its texture."""
    (tmp_path / "shapes.ray").write_text(SCENE)
    (tmp_path / "cells.png").write_bytes(cells())
    return tmp_path


@pytest.fixture
def viewer(browser, site):
    viewer = Viewer(browser, site)
    yield viewer
    viewer.close()
    assert not viewer.faults
