"""Pictures: against arithmetic, against the program, and against each other."""

import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import ROOT

import dotray

GROUP = [[0, -1, 0, 0.5], [2, 0, 0, 0], [0, 0, 1, -1], [0, 0, 0, 1]]


def everything():
    """A scene of every kind of thing."""
    random = np.random.default_rng(3)
    scene = dotray.Scene(background=(0.1, 0.2, 0.3), ambient="#202020")
    scene.look_at((1, 2, 9), (0, 0, 0), half_angle=0.35)
    scene.lights = [
        dotray.PointLight((5, 5, 5), attenuation=(1, 0.01, 0.002)),
        dotray.DirectionalLight((-1, -1, -2), (0.2, 0.2, 0.3)),
        dotray.SpotLight((0, 6, 2), (0, -1, 0), cutoff=0.6, dropoff=0.01),
        dotray.AreaLight((-3, 5, 4), (3, -5, -4), 0.5, "silver"),
    ]
    board = np.indices((4, 4)).sum(0) % 2
    tiles = dotray.Material("white", texture=np.repeat(board[:, :, None] * 255, 3, axis=2).astype(np.uint8))
    glass = dotray.Material((0, 0, 0), specular=(1, 1, 1), k_specular=0.1, k_transmission=0.8, index_of_refraction=1.5)
    scene.add_spheres(random.random((40, 3)) * 4 - 2, random.random(40) * 0.2 + 0.1, color=random.random((40, 3)))
    scene.add_spheres([0, 0, 2], 0.8, material=glass)
    scene.add_boxes([0, -2.5, 0], (8, 0.2, 8), material=dotray.Material("gray", text="checker scale=2"))
    scene.add_cylinders([[-2, -2, 0], [2, -2, 0]], [[-2, 2, 0], [2, 2, 1]], [0.1, 0.2], color=["red", "blue"][0])
    scene.add_cones([[-1, -2, 1], [1, -2, 1]], [[-1, 0, 1], [1, 0, 1.5]], 0.4, [0, 0.2], color=np.eye(3)[:2])
    material = dotray.Material("gold", specular=(0.5, 0.5, 0.5), k_specular=0.3)
    scene.add_cones([0, 2, 0], [0, 1, 0], 0, 0.3, material=material)
    vertices = np.array([[-1, 1, -1], [1, 1, -1], [1, 2.5, -1], [-1, 2.5, -1.5]])
    uv = np.array([[0, 1], [1, 1], [1, 0], [0, 0.0]])
    scene.add_triangles(vertices, [[0, 1, 2], [0, 2, 3]], uv=uv, material=tiles)
    scene.add_triangles(vertices + [0, -3, -1], [[0, 1, 2], [0, 2, 3]], normals=vertices, color=np.eye(3)[:2])
    group = scene.add_group(GROUP)
    group.add_spheres([[0, 0, 0], [1, 0, 0]], 0.3, material=material, color=np.float32([[1, 0.3, 0.2], [0.1, 1, 0.5]]))
    inner = group.add_group(np.diag([1, 0.5, 1, 1]))
    inner.add_boxes([0, 2, 0], 0.5, color=[0.3, 0.9, 0.4])
    inner.add_cylinders([1, 0, 0], [[1, 1, 0.5]], 0.2, caps=False, color=[0.2, 0.4, 0.9])
    scene.add_cones([[2, -1, 1], [-2, 2, 0]], [[2, 0, 0.5], [-2, 1, 1]], 0.3, [0.1, 0], caps=False, material=material)
    scene.add_spheres([2, 2, 0], 0.3)
    return scene


OPTIONS = [{}, {"aa": 2, "recursion": 3}, {"aa": "adaptive", "aa_depth": 2}, {"shadows": "opaque", "transparent": True}]
ARGUMENTS = [
    [],
    ["--aa", "grid=2", "--recursion", "3"],
    ["--aa", "adaptive", "--aa-depth", "2"],
    ["--shadows", "opaque", "--background", "transparent"],
]


@pytest.mark.parametrize("case", range(len(OPTIONS)))
def test_a_saved_scene_gives_the_same_bytes(case, program, tmp_path):
    scene = everything()
    image = scene.render(120, 90, light_samples=4, **OPTIONS[case])
    scene.save(tmp_path / "scene.ray")
    out = tmp_path / "out.exr"
    program("render", tmp_path / "scene.ray", out, "--size", "120x90", "--light-samples", "4", *ARGUMENTS[case], "-q")
    image.save(tmp_path / "own.exr")
    assert out.read_bytes() == (tmp_path / "own.exr").read_bytes()
    again = dotray.load(tmp_path / "scene.ray").render(120, 90, light_samples=4, **OPTIONS[case])
    assert (again.numpy() == image.numpy()).all()


def test_fitted_cameras_and_the_default_lamp_are_saved(program, tmp_path):
    scene = dotray.Scene()
    scene.add_spheres(np.eye(3), 0.4, color=np.eye(3))
    scene.fit((-1, -2, -1), up=(0, 0, 1))
    for size in [(64, 48), (48, 64)]:
        scene.save(tmp_path / "a.ray", *size)
        program("render", tmp_path / "a.ray", tmp_path / "a.png", "--size", "%dx%d" % size, "-q")
        scene.render(*size).save(tmp_path / "b.png")
        assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
        shown = scene.render(*size, layers="shape").layers["shape"]
        assert (shown[[0, -1]] == -1).all() and (shown[:, [0, -1]] == -1).all(), "all shapes are seen"


def test_a_loaded_scene_can_be_changed_and_saved(program, tmp_path):
    (tmp_path / "part.ray").write_text("#material 1 0 0 1 0 0 0 0 0 0 0 0 0 0 1 -1 !! #shape_sphere 0 0 0 0 1")
    text = (
        "#camera 0 0 9 0 0 -1 0 1 0 .4 #light_point 1 1 1 5 5 5 1 0 0 #ray_file part.ray "
        "#material 0 1 0 0 1 0 0 0 0 0 0 0 0 0 1 -1 !! #ray_file_instance 0 #shape_box 0 2 0 0 1 1 1"
    )
    (tmp_path / "main.ray").write_text(text)
    scene = dotray.load(tmp_path / "main.ray")
    assert scene.camera.position == (0, 0, 9) and len(scene.lights) == 1 and scene.background == (0, 0, 0)
    program("render", tmp_path / "main.ray", tmp_path / "a.png", "--size", "64x48", "-q")
    scene.render(64, 48).save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert scene.add_spheres([-2, 0, 0], 0.7, color=[[0, 0, 1]]) == 1
    scene.background, scene.lights = "white", [dotray.PointLight((0, 9, 9))]
    scene.look_at((0, 2, 9), (0, 0, 0))
    scene.save(tmp_path / "changed.ray")
    program("render", tmp_path / "changed.ray", tmp_path / "a.png", "--size", "64x48", "-q")
    scene.render(64, 48).save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    found = dotray.RayCaster(scene).cast_rays([[x, 0, 9, 0, 0, -1] for x in (0, 2, -2)])
    assert found["geometry_ids"].tolist() == [0, 0, 1] and found["primitive_ids"].tolist() == [0, 1, 0]
    with pytest.raises(ValueError, match="part.ray"):
        (tmp_path / "other").mkdir()
        scene.save(tmp_path / "other/changed.ray")


def test_what_is_added_to_another_dialect_is_saved_or_refused(tmp_path):
    for name in ["blocks-unisa.scene", "pipes-hmc.ray"]:
        scene = dotray.load(ROOT / "scenes/dialects" / name)
        own = "#version HMC" if name.startswith("pipes") else " 0 1 0 25\n"
        assert own in scene.to_ray(), "unchanged it stays in its own words, such as angles in degrees"
        vertices = np.array([[-1, 0, 2], [1, 0, 2], [0, 2, 2.0]])
        scene.add_triangles(vertices, [[0, 1, 2]], color="red")
        if name.startswith("pipes"):
            with pytest.raises(ValueError, match=r"pipes-hmc.ray:\d+:\d+: `slides` has no torus"):
                scene.to_ray()
            continue
        path = tmp_path / "whole.ray"
        path.write_text(scene.to_ray())
        assert own not in path.read_text()
        apart = abs(dotray.load(path).render(80, 60).numpy() - scene.render(80, 60).numpy())
        assert np.mean(apart > 1e-5) < 0.001


def test_a_sphere_is_shaded_by_the_formula():
    scene = dotray.Scene(background="black", ambient=(0.5, 0.5, 0.5))
    scene.camera = dotray.Camera((0, 0, 10), (0, 0, -1), half_angle=0.2)
    scene.lights = [dotray.DirectionalLight((0, 0, -1))]
    scene.add_spheres([0, 0, 0], 1, material=dotray.Material(diffuse=(0.5, 0.25, 1), ambient=(0.2, 0.4, 0)))
    image = scene.render(201, 201, layers=["normal", "depth"])
    normals, depth = image.layers["normal"].astype(float), image.layers["depth"]
    met = np.isfinite(depth)
    expected = np.array([0.1, 0.2, 0]) + np.array([0.5, 0.25, 1]) * normals[..., 2:]
    assert abs(image.numpy() - expected)[met].max() < 1e-6
    assert (image.numpy()[~met] == 0).all() and 0.1 < met.mean() < 0.5
    assert depth[100, 100] == 9


def test_colours_of_single_shapes_equal_materials_of_their_own():
    random = np.random.default_rng(1)
    centers, shades = random.random((30, 3)) * 4, random.random((30, 3)).astype(np.float32)
    base = dotray.Material((0.9, 0.8, 0.7), specular=(0.3, 0.3, 0.3), k_specular=0.4)
    one, each = dotray.Scene(), dotray.Scene()
    one.add_spheres(centers, 0.3, material=base, color=shades)
    for center, shade in zip(centers, shades):
        each.add_spheres(center, 0.3, material=base.colored(tuple(shade.astype(float).tolist())))
    assert (one.render(90, 60).numpy() == each.render(90, 60).numpy()).all()
    plain = dotray.Scene()
    plain.add_spheres(centers, 0.3, material=base)
    assert abs(one.render(90, 60).numpy() - plain.render(90, 60).numpy()).max() > 0.1


def test_every_layout_gives_the_same_picture():
    random = np.random.default_rng(2)
    centers = random.random((50, 3)).astype(np.float32)
    radii = (random.random(50) * 0.1 + 0.01).astype(np.float32)
    table = np.zeros((100, 8), np.float32)
    table[::2, 1:7:2], table[::2, 7] = centers, radii

    def picture(centers, radii):
        scene = dotray.Scene()
        scene.add_spheres(centers, radii)
        return scene.render(60, 40).numpy()

    first = picture(centers, radii)
    layouts = [
        (centers.astype(float), radii.astype(float)),
        (np.asfortranarray(centers), radii[:, None]),
        (table[::2, 1:7:2], table[::2, 7]),
        (centers[::-1][::-1], radii[::-1].copy()[::-1]),
        (centers.astype(">f4"), radii.astype(">f8")),
        (centers.tolist(), radii.tolist()),
    ]
    for layout in layouts:
        assert (picture(*layout) == first).all()
    same = picture(np.float32([0.5, 0.5, 0.5]), np.full(4, 0.25, np.float32))
    assert (same == picture([[0.5] * 3] * 4, 0.25)).all()


def test_broadcasting_copies_nothing():
    scene = dotray.Scene()
    centers = np.zeros((1000, 3), np.float32)
    scene.add_spheres(centers, 1.0, color=np.ones((1, 3)))
    record = scene._items[0]
    assert np.shares_memory(record.arrays["centers"], centers)
    assert record.arrays["radii"].strides == (0,) and record.colors.strides[0] == 0
    assert len(pickle.dumps(record)) < 14000
    again = pickle.loads(pickle.dumps(record))
    assert again.arrays["radii"].shape == (1000,) and again.colors.shape == (1000, 3)


def test_the_array_is_the_pictures_own_memory():
    scene = dotray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    image = scene.render(32, 24)
    array = image.numpy()
    assert array is image.numpy() and np.asarray(image) is array
    assert array.dtype == np.float32 and array.flags.c_contiguous and array.flags.writeable
    assert array.base is not None, "rust's memory"
    del image, scene
    gc.collect()
    assert np.isfinite(array).all()
    kept = np.zeros((4, 4, 3), np.float32)
    assert dotray.Image(kept).numpy() is kept


def test_pictures_go_to_files_and_back(tmp_path):
    scene = everything()
    image = scene.render(40, 30, light_samples=1, layers=["depth", "normal"])
    assert image.layers["depth"].shape == (30, 40) and image.layers["normal"].shape == (30, 40, 3)
    image.save(tmp_path / "a.exr")
    assert b"depth.Z" in (tmp_path / "a.exr").read_bytes()
    assert (dotray.Image.open(tmp_path / "a.exr").numpy() == image.numpy()).all()
    image.save(tmp_path / "a.png")
    bytes_ = np.floor(np.clip(image.numpy(), 0, 1) * 255 + 0.5)
    assert (np.round(dotray.Image.open(tmp_path / "a.png").numpy() * 255) == bytes_).all()
    assert image._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n" and image.png() == (tmp_path / "a.png").read_bytes()
    found = image.compare(dotray.Image.open(tmp_path / "a.png"), tolerance=0.01)
    assert found.pixels == 1200 and found.max > 0 and found.ssim > 0.99
    assert dotray.compare(image, image).max == 0
    with pytest.raises(ValueError, match="unknown picture format `.xyz`"):
        image.save(tmp_path / "a.xyz")
    with pytest.raises(OSError, match="none"):
        image.save(tmp_path / "none/a.png")
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "a.png"]


def test_threads_accelerators_and_crops_change_no_byte():
    scene = everything()
    whole = scene.render(80, 60, light_samples=2).numpy()
    for accel in ["brute", "boxes", "octree", "bsp"]:
        other = pickle.loads(pickle.dumps(scene))
        assert (other.render(80, 60, light_samples=2, accel=accel, threads=3).numpy() == whole).all()
    part = scene.render(80, 60, light_samples=2, crop=(10, 20, 30, 15)).numpy()
    assert (part == whole[20:35, 10:40]).all()


def test_the_view_changes_without_building_anew():
    scene = dotray.Scene()
    scene.add_spheres([0, 0, 0], 1, color="red")
    first = scene.render(32, 24).numpy()
    world = scene._world
    scene.look_at((5, 5, 5), (0, 0, 0))
    scene.lights, scene.background, scene.ambient = [], "navy", (1, 1, 1)
    second = scene.render(32, 24).numpy()
    assert scene._world is world and second[0, 0].tolist() == [0, 0, 0.5] and second[12, 16].tolist() == [1, 0, 0]
    scene.camera, scene.lights, scene.background, scene.ambient = None, None, "white", (0.3, 0.3, 0.3)
    assert (scene.render(32, 24).numpy() == first).all()
    scene.add_spheres([1, 0, 0], 1)
    assert scene.render(32, 24).numpy().tolist() != first.tolist() and scene._world is not world


def test_explain_adds_up_to_the_picture():
    scene = everything()
    image = scene.render(60, 40, light_samples=2).numpy()
    for x, y in [(30, 20), (10, 30), (45, 12), (0, 0), (31, 17)]:
        ray = scene.explain(x, y, 60, 40, light_samples=2)
        assert np.float32(ray["color"]).tolist() == image[y, x].tolist()
    met = scene.explain(30, 20, 60, 40)["hit"]
    assert met["lights"][0]["light"] == 0 and len(met["normal"]) == 3
    assert isinstance(met["reflected"], (str, dict))


def test_check_tells_what_is_unlikely(tmp_path):
    scene = dotray.Scene()
    scene.lights = []
    scene.add_spheres([0, 0, 0], 1)
    assert [message.code for message in scene.check()] == ["no-light"]
    (tmp_path / "a.ray").write_text("#camera 0 0 9 0 0 -1 0 1 0 .4\n#light_num 3\n#shape_sphere -1 0 0 0 1\n")
    messages = dotray.load(tmp_path / "a.ray").check()
    assert any(message.place and message.place[1] == 2 for message in messages)
    assert "a.ray:2:" in " ".join(map(str, messages))


def test_progress_is_told_and_an_error_in_it_stops():
    scene = dotray.Scene()
    random = np.random.default_rng(0)
    scene.add_spheres(random.random((1000, 3)), 0.02)
    told = []
    scene.render(400, 300, aa=3, layers=["depth"], crop=(10, 20, 300, 200), progress=told.append)
    events = [record["event"] for record in told]
    assert events[0] == "picture" and set(events) == {"picture", "layers", "progress"}
    middle = events.index("layers")
    for part in (told[:middle], told[middle:]):
        begun, *steps = part
        assert begun["total_pixels"] == 60000 and (begun["width"], begun["height"]) == (300, 200)
        finished = [record["finished_pixels"] for record in steps]
        assert finished == sorted(finished) and finished[-1] == 60000
        assert steps[-1]["seconds_left"] == 0 and steps[-1]["pixels_per_second"] > 0
    seconds = [record["seconds"] for record in told]
    assert seconds == sorted(seconds)

    def refuse(*_):
        raise KeyError("enough")

    start = time.monotonic()
    with pytest.raises(KeyError, match="enough"):
        scene.render(4000, 3000, aa=8, progress=refuse)
    assert time.monotonic() - start < 10


@pytest.mark.parametrize("with_tqdm", [True, False])
def test_a_bar_is_shown(with_tqdm, capsys, monkeypatch):
    if not with_tqdm:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    scene = dotray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    scene.render(64, 48, progress=True)
    assert "dotray" in capsys.readouterr().err
    scene.render(64, 48)
    assert capsys.readouterr().err == "", "nobody looks"


# A shell that puts its jobs into the background has them ignore the signal.
CTRL_C = """
import numpy as np, dotray, signal, time
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = dotray.Scene()
scene.add_spheres(np.random.default_rng(0).random((1000, 3)), 0.02)
scene.render(16, 16)
print("ready", flush=True)
start = time.monotonic()
try:
    scene.render(8000, 6000, aa=16)
except KeyboardInterrupt:
    print("stopped", time.monotonic() - start, flush=True)
    print(scene.render(16, 16).numpy().shape)
"""


def test_ctrl_c_stops_a_picture():
    process = subprocess.Popen([sys.executable, "-c", CTRL_C], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert out.startswith("stopped") and "(16, 16, 3)" in out, out


def test_other_threads_of_python_run_meanwhile():
    scene = dotray.Scene()
    scene.add_spheres(np.random.default_rng(0).random((2000, 3)), 0.02)
    scene.render(16, 16)
    turns, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            turns[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = turns[0]
    start = time.monotonic()
    scene.render(800, 600, aa=4)
    taken = time.monotonic() - start
    stop.set()
    counter.join()
    assert turns[0] - before > taken * 5, (turns, taken)


def test_a_fork_can_render():
    scene = dotray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    scene.render(32, 24)
    caster = dotray.RayCaster(scene)
    caster.cast_rays([[0, 0, 5, 0, 0, -1]])
    child = os.fork()
    if child == 0:
        scene.render(32, 24)
        found = caster.cast_rays([[0, 0, 5, 0, 0, -1]])
        os._exit(0 if found["t_hit"][0] == 4 else 1)
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            assert status == 0
            return
        time.sleep(0.05)
    os.kill(child, signal.SIGKILL)
    pytest.fail("the child hangs")
