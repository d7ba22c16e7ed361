"""The page, with files that are dropped on it: nothing is served but the page itself."""

import time

import numpy
import pytest
from conftest import SCENE, Viewer, cells, launched, pixels, rendered

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


# Mirrors and glass among each other under lamps of many points: a few rays take longer than a move may wait.
LAMPS = "\n".join(f"#light_area .1 .1 .1 {x} 9 6 -.1 -1 -.6 2 1 0 0" for x in range(-12, 12))
BALLS = [f"#shape_sphere 2 {x * 0.5} {y * 0.5} {(x * x + 3 * y) % 4} .24\n" for x in range(-9, 9) for y in range(-4, 9)]
HEAVY = SCENE.replace("#light_dir .3 .3 .3  -1 -1 -1", LAMPS).replace("#texture_num 1\n#texture cells.png\n", "")
HEAVY = HEAVY.replace("  0 !textured!", "  -1 !plain!").replace("#material_num 2", "#material_num 3")
HEAVY += "#material .1 .1 .1 .4 .4 .4 .5 .5 .5 0 0 0 .9 .9 1.5 -1 !glass!\n" + "".join(BALLS)

# Notes when a page's tracers are told something that cannot wait, and when they hear of it.
SENT = """
    globalThis.sent = {};
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (data, ...more) {
        if (data.turn) sent[data.turn] ??= performance.timeOrigin + performance.now();
        return post.call(this, data, ...more);
    };
"""
HEARD = """() => {
    globalThis.heard = {};
    addEventListener("message", ({ data }) => {
        if (data.turn) heard[data.turn] ??= performance.timeOrigin + performance.now();
    });
}"""


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
def test_a_move_is_heard_within_50_milliseconds(browser, request, server):
    viewer = Viewer(browser, request.getfixturevalue(server), size=(800, 450), prepare=lambda page: page.add_init_script(SENT))
    viewer.drop({"heavy.ray": HEAVY.encode()})
    viewer.wait("data-prepared", "true")
    viewer.wait("data-tracers", lambda count: count == str(len(viewer.page.workers)))
    for worker in viewer.page.workers:
        worker.evaluate(HEARD)
    assert viewer.page.evaluate("crossOriginIsolated") == (server == "apart")
    viewer.page.keyboard.press("t")
    # All of them are in the midst of heavy tiles.
    time.sleep(4)
    for turn in range(12):
        place = viewer.at(0.4 + 0.02 * turn, 0.5)
        viewer.page.mouse.move(*place)
        viewer.page.mouse.wheel(0, 40 if turn % 2 else -40)
        time.sleep(0.7)
    assert viewer.get("data-traced") == "false"
    sent = viewer.page.evaluate("sent")
    waits = []
    for worker in viewer.page.workers:
        heard = worker.evaluate("heard")
        waits += [heard[turn] - sent[turn] for turn in heard]
        assert len(heard) >= 12
    waits.sort()
    print(f"{len(waits)} waits of {len(viewer.page.workers)} tracers in ms:", [round(wait) for wait in waits])
    # Other programs may take the cores away for a while.
    assert waits[len(waits) * 3 // 4] < 50 and waits[-1] < 1000, waits
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
    viewer.page.wait_for_url("**/#webgl2", timeout=60000)
    viewer.page.wait_for_function("document.getElementById('message').textContent.includes('WebGL2')")
    viewer.drop(BOTH)
    assert (viewer.trace() == pixels(rendered(scene, "shapes.ray", viewer.view()[2:]))).all()
    browser.close()


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
