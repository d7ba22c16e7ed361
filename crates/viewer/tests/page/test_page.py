"""The page, with files that are dropped on it: nothing is served but the page itself."""

import base64
import os
import subprocess
import time

import numpy
import pytest
from conftest import HEARD, HEAVY, NOTES, SCENE, Moves, Viewer, cells, judge, launched, pixels, rendered

BOTH = {"shapes.ray": SCENE.encode(), "cells.png": cells()}


def test_a_scene_is_shown_orbited_and_traced_as_by_dotray_render(viewer, scene, site):
    viewer.drop(BOTH)
    viewer.wait("data-shapes", "3")
    assert viewer.get("data-scene") == "shapes.ray" and viewer.get("data-messages") == ""
    preview = viewer.shot()
    assert len(numpy.unique(preview.reshape(-1, 3), axis=0)) > 200
    # Orbit, and back.
    camera = viewer.get("data-camera")
    viewer.drag(viewer.at(0.5, 0.5), viewer.at(0.8, 0.4))
    viewer.wait("data-camera", lambda now: now != camera)
    assert (viewer.shot() != preview).any(axis=2).mean() > 0.2
    viewer.page.keyboard.press("r")
    viewer.wait("data-camera", camera)
    assert (viewer.shot() == preview).all()
    # Traced: every pixel.
    traced = viewer.trace()
    wanted = rendered(scene, "shapes.ray", viewer.view()[2:])
    assert (traced == pixels(wanted)).all()
    # Rasterised and traced show the same but for shadows and mirrors.
    assert numpy.abs(preview.astype(int) - traced).mean() < 40
    # Saved: the very bytes.
    with viewer.page.expect_download() as download:
        viewer.page.keyboard.press("Control+s")
    assert download.value.suggested_filename == "shapes.png"
    assert open(download.value.path(), "rb").read() == wanted
    # Nothing has left the machine.
    assert all(method == "GET" and url.startswith((site, "blob:")) for method, url in viewer.requests)


def test_several_tracers_make_the_picture_of_dotray_render(browser, site, scene):
    """However many threads the browser says there are: here five on few cores."""
    cores = "Object.defineProperty(Navigator.prototype, 'hardwareConcurrency', { get: () => 5 })"
    viewer = Viewer(browser, site, size=(900, 500), prepare=lambda page: page.add_init_script(cores))
    viewer.drop(BOTH)
    viewer.wait("data-tracers", "5")
    assert len(viewer.page.workers) == 5
    # What comes from others is counted where it arrives.
    leader = next(each for each in viewer.page.workers if each.evaluate("(rayview.mates ?? []).length") == 4)
    count = "for (const mate of rayview.mates) mate.addEventListener('message', () => parts++);"
    leader.evaluate("() => { globalThis.parts = 0; " + count + " }")
    traced = viewer.trace()
    assert (traced == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()
    assert leader.evaluate("parts") > 4
    # Once more after a move, and as a file.
    viewer.drag(viewer.at(0.5, 0.5), viewer.at(0.6, 0.45))
    viewer.wait("data-traced", "true", seconds=120)
    moved = viewer.shot()
    assert (moved != traced).any()
    viewer.page.keyboard.press("r")
    viewer.wait("data-traced", "false")
    viewer.wait("data-traced", "true", seconds=120)
    with viewer.page.expect_download() as download:
        viewer.page.keyboard.press("Control+s")
    assert open(download.value.path(), "rb").read() == rendered(scene, "shapes.ray", viewer.view()[2:])
    viewer.close()


@pytest.mark.parametrize("server", ["site", "apart"])
def test_a_move_is_heard_soon(browser, request, server):
    prepare = lambda page: page.add_init_script(NOTES)
    viewer = Viewer(browser, request.getfixturevalue(server), size=(800, 450), prepare=prepare)
    viewer.drop({"heavy.ray": HEAVY.encode()})
    viewer.wait("data-prepared", "true")
    viewer.wait("data-tracers", lambda count: count == str(len(viewer.page.workers)))
    for worker in viewer.page.workers:
        worker.evaluate(HEARD)
    assert viewer.page.evaluate("crossOriginIsolated") == (server == "apart")
    viewer.page.keyboard.press("t")
    # All of them are in the midst of heavy tiles.
    time.sleep(4)
    moves = Moves(viewer.page, viewer.at)
    waits = moves.by_workers(viewer.page)
    assert viewer.get("data-traced") == "false"
    judge(moves, waits)
    viewer.close()


# Counts the frames in which something is drawn.
FRAMES = """
    globalThis.frames_drawn = 0;
    let drawn = false;
    for (const name of ["drawElements", "drawElementsInstanced"]) {
        const draw = WebGL2RenderingContext.prototype[name];
        WebGL2RenderingContext.prototype[name] = function (...more) {
            drawn = true;
            return draw.apply(this, more);
        };
    }
    const request = requestAnimationFrame.bind(globalThis);
    globalThis.requestAnimationFrame = (call) => request((time) => {
        drawn = false;
        call(time);
        frames_drawn += drawn;
    });
"""


def test_what_a_hand_does_costs_few_frames_where_they_are_slow(browser, site):
    viewer = Viewer(browser, site, prepare=lambda page: page.add_init_script(FRAMES))
    viewer.drop(BOTH)
    viewer.wait("data-prepared", "true")

    def frames(deeds):
        """How many frames there are from these deeds until all is still."""
        viewer.page.evaluate("frames_drawn = 0")
        deeds()
        time.sleep(2)
        return viewer.page.evaluate("frames_drawn")

    def hover():
        x, y = viewer.at(0.5, 0.5)
        for step in range(12):
            viewer.page.mouse.move(x + step, y)
            time.sleep(0.05)

    frames(hover)
    # One when it rests, some for what is told of the place then; without waiting there are 17 and more.
    assert 1 <= frames(hover) <= 6
    camera = viewer.get("data-camera")
    # Without waiting there are seven and more.
    assert 1 <= frames(lambda: viewer.page.mouse.wheel(0, 120)) <= 5
    assert viewer.get("data-camera") != camera
    viewer.close()


# A device of WebGPU that draws by software.
WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--use-vulkan=swiftshader"]
WEBGPU += ["--enable-features=Vulkan,WebGPU", "--disable-vulkan-surface"]


def test_where_webgpu_fails_webgl_draws_and_the_page_says_so(playwright, site, scene):
    browser = launched(playwright, *WEBGPU)
    # The browser takes the device away once the application has it, as where a driver has crashed.
    lose = """if (globalThis.GPUAdapter) {
        const request = GPUAdapter.prototype.requestDevice;
        GPUAdapter.prototype.requestDevice = async function (...more) {
            const device = await request.apply(this, more);
            const lost = new Promise((lose) => setTimeout(lose, 1500, { reason: "unknown", message: "a crash" }));
            Object.defineProperty(device, "lost", { value: lost });
            return device;
        };
    }"""
    viewer = Viewer(browser, site, prepare=lambda page: page.add_init_script(lose))
    assert viewer.page.evaluate("'gpu' in navigator")
    viewer.page.wait_for_url("**/#webgl2-instead", timeout=60000)
    viewer.page.wait_for_function("document.getElementById('message').textContent.includes('WebGL2')")
    viewer.drop(BOTH)
    assert (viewer.trace() == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()
    browser.close()


# All kinds of shapes and lights, a texture, a 3-D texture, a bump, and a group that is no similarity.
ALL = SCENE.replace("!mirror!", "!marble scale=2 color2=.2,.2,.3; bump scale=5 height=.02!")
ALL += """#light_spot .6 .2 .2  -3 5 3  .5 -1 -.5  1 0 0  .5 .05
#light_area .3 .3 .5  4 3 3  -1 -.6 -.8  .3  1 .05 0
#shape_cone 0  1.3 1.6 -.5  .5 .9
#group_begin .9 0 .43 -.2  0 1.4 0 1.3  -.43 0 .9 -1  0 0 0 1
  #shape_sphere 1  0 0 0  .5
  #shape_triangle 0  -.6 .7 0  .6 .7 .4  0 1.6 -.4   0 0 0  0 0 0  0 0 0   0 1  1 1  .5 0
#group_end
"""

# The canvas itself: where there is no GPU, WebGPU's pictures are on no screenshot. They can be had right after a frame.
GRAB = """() => new Promise((done) => {
    const canvas = document.getElementById("view"), copy = document.createElement("canvas");
    [copy.width, copy.height] = [canvas.width, canvas.height];
    const context = copy.getContext("2d", { willReadFrequently: true });
    let left = 300;
    const look = () => {
        context.drawImage(canvas, 0, 0);
        if (context.getImageData(0, 0, 1, 1).data[0] || !left--) done(copy.toDataURL());
        else requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
})"""


def grabbed(viewer):
    """The view's pixels from the canvas, drawn anew."""
    viewer.wait("data-prepared", "true")
    x, y, width, height = map(int, viewer.view())
    viewer.page.mouse.move(20, 500)
    time.sleep(0.5)
    viewer.page.mouse.move(24, 504)
    address = viewer.page.evaluate(GRAB)
    return pixels(base64.b64decode(address.partition(",")[2]))[y : y + height, x : x + width].astype(int)


def in_a_window(display, path, place):
    """The view's pixels of the program's own window of the page's size."""
    x, y, width, height = map(int, place)
    environment = {**os.environ, "DISPLAY": display, "LIBGL_ALWAYS_SOFTWARE": "1"}
    environment.pop("WAYLAND_DISPLAY", None)
    last = None
    with subprocess.Popen([os.environ["RAYVIEW"], path, "--window", "1100x640"], env=environment) as program:
        until = time.monotonic() + 120
        while time.monotonic() < until:
            time.sleep(1)
            command = ["import", "-window", "root", "-depth", "8", "png24:-"]
            shot = pixels(subprocess.run(command, env=environment, check=True, capture_output=True).stdout)
            shot = shot[y : y + height, x : x + width].astype(int)
            # It stands still, and there is a picture.
            if last is not None and (shot == last).all() and len(numpy.unique(shot.reshape(-1, 3), axis=0)) > 200:
                break
            last = shot
        program.kill()
    return shot


def test_web_gpu_draws_what_web_gl_and_a_window_draw(playwright, browser, site, display, scene):
    (scene / "all.ray").write_text(ALL)
    files = {"all.ray": ALL.encode(), "cells.png": cells()}
    modern = launched(playwright, *WEBGPU, display=display)
    by_gpu = Viewer(modern, site)
    has = by_gpu.page.evaluate("navigator.gpu?.requestAdapter().then((adapter) => Boolean(adapter)) ?? false")
    if not has:
        modern.close()
        pytest.skip("this Chromium has no adapter for WebGPU")
    by_gl = Viewer(browser, site)
    for each in (by_gpu, by_gl):
        each.drop(files)
    pictures = [grabbed(each) for each in (by_gpu, by_gl)]
    assert "WebGPU" in by_gpu.get("data-device") and "WebGL" in by_gl.get("data-device")
    place = by_gl.view()
    assert by_gpu.view() == place and by_gpu.get("data-messages") == ""
    pictures.append(in_a_window(display, scene / "all.ray", place))
    assert len(numpy.unique(pictures[0].reshape(-1, 3), axis=0)) > 1000
    # Edges of shapes fall on one pixel or the next; another driver rounds textures and bumps otherwise.
    for other, name, levels, most in zip(pictures[1:], ("WebGL2", "the window"), (2, 6), (0.002, 0.02)):
        off = numpy.abs(pictures[0] - other).max(axis=2)
        print(f"WebGPU and {name}: {(off > 0).mean():.6f} of the pixels differ, {(off > levels).mean():.6f} by much")
        assert (off > levels).mean() < most
    modern.close()
    by_gl.close()


def test_web_gl_is_chosen_by_the_address(browser, site):
    viewer = Viewer(browser, site + "#webgl2")
    said = viewer.page.locator("#message").inner_text()
    assert "as the address asks" in said and "does not work" not in said
    assert "WebGL" in viewer.get("data-device")
    viewer.close()


def test_hidden_shapes_are_not_traced(viewer, scene):
    viewer.drop(BOTH)
    viewer.wait("data-prepared", "true")
    viewer.click(*viewer.at(0.36, 0.45))
    viewer.wait("data-selected", "sphere 1 · shapes.ray:13")
    viewer.trace()
    whole = pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))
    viewer.page.keyboard.press("h")
    viewer.page.keyboard.press("Escape")
    viewer.wait("data-hidden", "1")
    viewer.wait("data-traced", "true", seconds=120)
    (scene / "less.ray").write_text("".join(line for line in SCENE.splitlines(True) if "shape_sphere" not in line))
    less = viewer.shot()
    assert (less != whole).any()
    assert (less == pixels(rendered(scene, "less.ray", viewer.view()[2:]))).all()
    assert "hidden shapes left out" in viewer.get("aria-label")
    viewer.page.keyboard.press("Shift+h")
    viewer.wait("data-hidden", "0")
    viewer.wait("data-traced", "true", seconds=120)
    assert (viewer.shot() == whole).all()


def test_a_click_shows_the_rays_of_a_pixel(viewer):
    viewer.drop(BOTH)
    viewer.wait("data-prepared", "true")
    viewer.click(*viewer.at(0.36, 0.45))
    rays = int(viewer.wait("data-rays", lambda rays: rays != "0"))
    assert rays > 1
    assert viewer.get("data-selected") == "sphere 1 · shapes.ray:13"


def test_faults_are_told_over_the_last_good_picture(viewer):
    viewer.drop(BOTH)
    viewer.wait("data-prepared", "true")
    good = viewer.shot()
    viewer.drop({"shapes.ray": SCENE.replace("-1.2 .9 0  1", "-1.2 .9 wide  1").encode()})
    message = viewer.wait("data-messages", bool)
    assert "shapes.ray:13" in message and "error" in message
    assert viewer.get("data-shapes") == "3"
    # The messages' window lies over the lower part.
    upper = good.shape[0] // 3
    assert (viewer.shot()[:upper] == good[:upper]).all()
    viewer.drop({"shapes.ray": (SCENE + "#shape_sphere 1  0 2 0  .4\n").encode()})
    viewer.wait("data-shapes", "4")
    viewer.wait("data-messages", "")
    viewer.wait("data-prepared", "true")


def test_a_texture_that_is_missing_may_come_later(viewer):
    viewer.drop({"shapes.ray": SCENE.encode()})
    message = viewer.wait("data-messages", bool)
    assert "cells.png" in message
    viewer.drop({"Cells.PNG": cells()})
    viewer.wait("data-messages", "")
    viewer.wait("data-prepared", "true")


def test_files_can_be_picked(viewer, scene):
    with viewer.page.expect_file_chooser() as chooser:
        viewer.click(40, 12)
    chooser.value.set_files([scene / "shapes.ray", scene / "cells.png"])
    viewer.wait("data-shapes", "3")


def test_dense_screens_have_dense_pictures(playwright, site, scene):
    browser = launched(playwright, "--force-device-scale-factor=2", "--window-size=800,400")
    viewer = Viewer(browser, site, scale=2)
    viewer.drop(BOTH)
    traced = viewer.trace()
    assert viewer.page.evaluate("devicePixelRatio") == 2
    # Twice as many pixels as points, between the panels.
    assert abs(viewer.view()[2] - 2 * (viewer.page.evaluate("innerWidth") - 300 - 310)) < 20
    assert (traced == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()
    browser.close()


def test_a_page_without_workers_traces_by_itself(browser, site, scene):
    block = lambda page: page.route("**/tracer.js", lambda route: route.abort())
    viewer = Viewer(browser, site, size=(800, 400), prepare=block)
    viewer.drop(BOTH)
    assert (viewer.trace() == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()
    viewer.close()
