"""The page, with files that are dropped on it: nothing is served but the page itself."""

import numpy
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
