"""Pictures on many workers: the same bytes as on one machine, whatever is lost on the way."""

import json
import multiprocessing
import os
import pickle
import shutil
import signal
import struct
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from engines import Dask, count_loads, loads_so_far
from many_hosts import film, scene

import dotray
from dotray import _pieces, cluster

HERE = Path(__file__).parent
OPTIONS = {"aa": "adaptive", "layers": ["depth", "normal"]}


@pytest.fixture(scope="module")
def expected():
    return scene().render(200, 150, **OPTIONS)


@pytest.fixture(scope="module")
def dask():
    with Dask() as engine:
        engine.add_worker()
        engine.add_worker()
        yield engine.client(2)


def check(image, expected):
    assert (image.numpy() == expected.numpy()).all()
    assert set(image.layers) == set(expected.layers)
    for name, layer in expected.layers.items():
        assert (image.layers[name] == layer).all()


def processes():
    return ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn"))


@pytest.mark.parametrize("engine", ["threads", "processes", "dask", "client"])
def test_every_engine_gives_the_same_bytes(engine, expected, request):
    if engine in ("dask", "client"):
        client = request.getfixturevalue("dask")
        executor = client if engine == "client" else client.get_executor(pure=False, retries=3)
        check(scene().render(200, 150, executor=executor, **OPTIONS), expected)
        return
    with ThreadPoolExecutor(3) if engine == "threads" else processes() as executor:
        check(scene().render(200, 150, executor=executor, **OPTIONS), expected)
        crop = (10, 20, 90, 70)
        part = cluster.render(scene(), 200, 150, executor=executor, crop=crop, piece=32, **OPTIONS)
        assert (part.numpy() == expected.numpy()[20:90, 10:100]).all()


def test_the_scene_reaches_each_worker_once(dask):
    cluster.render(scene(), 200, 150, executor=dask, piece=32)
    dask.run(count_loads)
    made = scene()
    made.add_boxes([0.5, 0.5, 0.5], 0.1)
    cluster.render(made, 200, 150, executor=dask, piece=32)
    loads = dask.run(loads_so_far)
    assert len(loads) == 2 and set(loads.values()) <= {0, 1} and 1 in loads.values(), loads


class Unreliable(Executor):
    """Every third task is lost, and the first ones find no file."""

    def __init__(self, losses=1000):
        self.submitted, self.losses = 0, losses
        self.with_scene = 0

    def submit(self, function, scene_, piece):
        future = Future()
        self.submitted += 1
        if scene_.content is None:
            scene_ = _pieces.Travelling(scene_.key, "/nowhere/at/all")
        else:
            self.with_scene += 1
        try:
            if self.submitted % 3 == 0 and self.losses:
                self.losses -= 1
                raise ConnectionResetError("gone")
            future.set_result(function(scene_, piece))
        except Exception as fault:
            future.set_exception(fault)
        return future


def test_lost_pieces_are_computed_again(expected):
    _pieces._worlds.clear()
    executor = Unreliable()
    check(cluster.render(scene(), 200, 150, executor=executor, piece=32, retries=8, **OPTIONS), expected)
    assert executor.with_scene > 0, "who cannot read the file is sent the scene"
    _pieces._worlds.clear()
    with pytest.raises(cluster.LostWork, match="lost too often: gone"):
        cluster.render(scene(), 200, 150, executor=Unreliable(), piece=32, retries=0)


def test_faults_of_the_caller_are_not_tried_again(expected):
    executor = Unreliable(0)
    with pytest.raises(ValueError, match="aa is"):
        cluster.render(scene(), 200, 150, executor=executor, aa="smooth")
    assert executor.submitted < 10
    for arguments, message in [
        ({"piece": 40}, "multiple of 32"),
        ({"retries": -1}, "retries"),
        ({"piece": 8}, "piece"),
        ({"executor": 3}, "executor is 3: expected an executor"),
    ]:
        with pytest.raises(ValueError, match=message):
            cluster.render(scene(), 200, 150, **{"executor": executor, **arguments})


class Counting(ThreadPoolExecutor):
    submitted, most = 0, 1000

    def submit(self, *arguments):
        self.submitted += 1
        if self.submitted > self.most:
            raise KeyboardInterrupt
        return super().submit(*arguments)


def test_pieces_go_to_disk_and_are_found_again(expected, tmp_path):
    def files():
        return sorted(path.name for path in tmp_path.glob("*.tiles"))

    arguments = {"directory": tmp_path, "piece": 64, **OPTIONS}
    with Counting(1) as executor:
        executor.most = 7
        with pytest.raises(KeyboardInterrupt):
            cluster.render(scene(), 200, 150, executor=executor, **arguments)
    kept = len(files())
    with Counting(1) as executor:
        check(cluster.render(scene(), 200, 150, executor=executor, **arguments), expected)
        # 35 tiles of the picture by fours, 38 bands of the layers by fives.
        all_, first = files(), executor.submitted
        assert len(all_) == 9 + 8 == kept + first
        check(cluster.render(scene(), 200, 150, executor=executor, **arguments), expected)
        assert executor.submitted == first, "the second time all pieces are there"
        # A damaged piece is computed again, and so is one of another picture.
        content = bytearray((tmp_path / all_[3]).read_bytes())
        content[len(content) // 2] ^= 1
        (tmp_path / all_[3]).write_bytes(content)
        cluster.render(scene(), 200, 150, executor=executor, **{**arguments, "aa": 2})
        assert executor.submitted == first + 17, "other options are another picture"
        other = next(name for name in files() if name not in all_)
        (tmp_path / all_[5]).write_bytes((tmp_path / other).read_bytes())
        check(cluster.render(scene(), 200, 150, executor=executor, **arguments), expected)
        assert executor.submitted == first + 19, "two of them again"
    assert not list(tmp_path.glob("*.scene")) and len(files()) == 34


def test_what_comes_back_damaged_is_computed_again(expected):
    class Damaging(Counting):
        damaged = 0

        def submit(self, function, *arguments):
            def work(*given):
                found = bytearray(function(*given))
                if self.damaged < 3:
                    self.damaged += 1
                    found[len(found) // 2] ^= 0x10
                return bytes(found)

            return super().submit(work, *arguments)

    with Damaging(1) as executor:
        check(cluster.render(scene(), 200, 150, executor=executor, piece=64, **OPTIONS), expected)
        assert executor.damaged == 3 and executor.submitted == 17 + 3
    with Damaging(1) as executor:
        executor.damaged = -1000
        with pytest.raises(cluster.LostWork, match="it came back damaged"):
            cluster.render(scene(), 200, 150, executor=executor, piece=64, retries=0)


def test_frames_that_are_there_are_left(tmp_path):
    with ThreadPoolExecutor(2) as executor:
        first, _ = film(executor, tmp_path)
        (tmp_path / "03.png").unlink()
        (tmp_path / "04.png").write_bytes(b"mine")
        again, _ = film(executor, tmp_path)
    assert again[4] == b"mine" and again[:4] == first[:4] and again[5:] == first[5:]
    with pytest.raises(ValueError, match="a place for the frame's number"):
        cameras = [dotray.Camera((0, 0, 5), (0, 0, -1))] * 2
        cluster.frames(scene(), cameras, str(tmp_path / "all.png"), 8, 8, executor=ThreadPoolExecutor(1))


def test_a_pool_that_breaks_is_made_again(tmp_path):
    pools = []

    def make():
        pools.append(processes())
        return pools[-1]

    def kill():
        os.kill(next(iter(pools[0]._processes)), signal.SIGKILL)

    with ThreadPoolExecutor(2) as executor:
        quiet, _ = film(executor, tmp_path / "quiet")
    disturbed, _ = film(make, tmp_path / "disturbed", kill)
    assert disturbed == quiet and len(pools) > 1
    with processes() as broken:
        pools[:] = [broken]
        with pytest.raises(cluster.LostWork, match="give a function that makes one|lost too often"):
            film(broken, tmp_path / "broken", kill)


def die_sending(once):
    """Initializes a worker that is killed in the midst of its second result, unless the file ``once`` is there."""
    from multiprocessing.connection import Connection

    whole, sent = Connection.send_bytes, []

    def send_bytes(self, content):
        sent.append(content)
        if len(sent) == 2:
            try:
                once.touch(exist_ok=False)
            except FileExistsError:
                pass
            else:
                os.write(self.fileno(), struct.pack("!i", len(content)) + bytes(content[: len(content) // 2]))
                os.kill(os.getpid(), signal.SIGKILL)
        whole(self, content)

    Connection.send_bytes = send_bytes


def test_a_worker_killed_in_the_midst_of_sending_holds_nothing_up(expected, tmp_path):
    # Each half has a file of its own: a worker of the first that had one piece sends its goodbye as its second message.
    def make(once):
        context = multiprocessing.get_context("spawn")
        pools.append(ProcessPoolExecutor(2, mp_context=context, initializer=die_sending, initargs=(tmp_path / once,)))
        return pools[-1]

    pools = []
    check(cluster.render(scene(), 200, 150, executor=lambda: make("renewed"), piece=64, **OPTIONS), expected)
    assert len(pools) == 2
    fault = "give a function that makes one|lost too often"
    with make("broken") as broken, pytest.raises(cluster.LostWork, match=fault):
        cluster.render(scene(), 200, 150, executor=broken, piece=64)


def test_a_killed_worker_of_dask_loses_nothing(tmp_path, capsys):
    with Dask() as engine:
        workers = [engine.add_worker("--no-nanny") for _ in range(2)]
        client = engine.client(2)
        quiet, quiet_seconds = film(client, tmp_path / "quiet")
        disturbed, seconds = film(client, tmp_path / "disturbed", lambda: os.kill(workers[1].pid, signal.SIGKILL))
    assert disturbed == quiet
    with capsys.disabled():
        print(f"\n  one of two workers killed: 24 of 24 frames, {seconds:.1f} s ({quiet_seconds:.1f} s undisturbed)")


def namespaces():
    """Whether this machine lets us make networks of our own."""
    if not (shutil.which("unshare") and shutil.which("ip")):
        return False
    script = "ip link add cable2 type veth peer name eth0 && ip link add switch type bridge"
    command = ["unshare", "-n", "-m", "-p", "-f", "--mount-proc", "sh", "-c", script]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("how", ["host", "cable"])
def test_a_lost_host_and_a_pulled_cable_lose_nothing(how, tmp_path, capsys):
    if not namespaces():
        pytest.skip("no network namespaces on this machine")
    command = ["unshare", "-n", "-m", "-p", "-f", "--mount-proc", "--kill-child", sys.executable]
    start = time.monotonic()
    done = subprocess.run(
        [*command, str(HERE / "many_hosts.py"), how, str(tmp_path)], capture_output=True, text=True, timeout=400,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["same"]
    with capsys.disabled():
        print(
            f"\n  {how} lost: 24 of 24 frames, {found['disturbed']:.1f} s ({found['quiet']:.1f} s undisturbed), "
            f"{time.monotonic() - start:.0f} s in all"
        )


def test_a_scene_travels_with_what_it_needs(tmp_path):
    (tmp_path / "part.ray").write_text(
        "#texture t.png\n#material 1 1 1 1 1 1 0 0 0 0 0 0 0 0 1 0 !!\n#shape_box 0 0 0 0 2 2 2"
    )
    (tmp_path / "main.ray").write_text(
        "#camera 0 0 9 0 0 -1 0 1 0 .2 #light_point 1 1 1 5 5 5 1 0 0 #ray_file part.ray #ray_file_instance 0"
    )
    dotray.Image(np.random.default_rng(0).random((4, 4, 3))).save(tmp_path / "t.png")
    loaded = dotray.load(tmp_path / "main.ray")
    loaded.add_spheres([0, 1, 1], 0.5, material=dotray.Material(texture=np.random.default_rng(1).random((4, 4, 3))))
    expected = loaded.render(64, 48).numpy()
    content = pickle.dumps(loaded)
    for file in tmp_path.iterdir():
        file.unlink()
    assert (pickle.loads(content).render(64, 48).numpy() == expected).all()
