"""Pictures on the workers of Ray and of MPI: the same bytes, and what a killed worker costs."""

import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from many_hosts import film

HERE = Path(__file__).parent
SCRIPT = str(HERE / "more_engines.py")


def run(command, timeout=600):
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
        env={**os.environ, "PYTHONPATH": str(HERE), "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"},
    )
    found = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else None
    return done, found


@pytest.fixture(scope="module")
def quiet(tmp_path_factory):
    with ThreadPoolExecutor(2) as executor:
        return film(executor, tmp_path_factory.mktemp("quiet"))[0]


def in_namespaces(how, folder):
    """Runs an engine where nothing of it outlives the test: in namespaces of its own."""
    module = "ray" if how.startswith("ray") else "mpi4py"
    if importlib.util.find_spec(module) is None:
        pytest.skip(f"no {module}")
    inside = f"ip link set lo up; exec {sys.executable} {SCRIPT} {how} {folder}"
    command = ["unshare", "-n", "-m", "-p", "-f", "--mount-proc", "--kill-child", "sh", "-c", inside]
    probe = ["unshare", "-n", "-m", "-p", "-f", "--mount-proc", "sh", "-c"]
    probe.append("ip link set lo up && ip link add cable type veth peer name other")
    if not shutil.which("ip") or subprocess.run(probe, capture_output=True, check=False).returncode:
        pytest.skip("no network namespaces on this machine")
    done, found = run(command)
    assert found is not None, done.stdout + done.stderr
    return found


@pytest.mark.parametrize("engine", ["ray", "mpi"])
def test_a_cable_is_pulled(tmp_path, capsys, engine):
    launcher = Path(sys.executable).with_name("mpiexec")
    if engine == "mpi" and not (launcher.exists() and b"HYDRA" in version(launcher) and shutil.which("nsenter")):
        pytest.skip("no mpich")
    found = in_namespaces(f"{engine}-cable", tmp_path)
    assert found["same"], found
    with capsys.disabled():
        print(
            f"\n  {engine}, the cable of one of two hosts pulled: 24 of 24 frames, {found['cable']:.1f} s "
            f"({found['quiet']:.1f} s undisturbed)"
        )


def test_ray(tmp_path, capsys):
    start = time.monotonic()
    found = in_namespaces("ray", tmp_path)
    assert found["same"] and found["picture"] and found["layers"], found
    with capsys.disabled():
        print(
            f"\n  Ray, a worker killed: 24 of 24 frames, {found['worker']:.1f} s; one of two nodes killed: "
            f"{found['node']:.1f} s ({found['quiet']:.1f} s undisturbed); {time.monotonic() - start:.0f} s in all"
        )


def mpi(*arguments):
    launcher = Path(sys.executable).with_name("mpiexec")
    found = str(launcher) if launcher.exists() else shutil.which("mpiexec")
    if found is None or importlib.util.find_spec("mpi4py") is None:
        pytest.skip("no mpi4py or no mpiexec")
    more = ["--allow-run-as-root", "--oversubscribe"] if b"Open MPI" in version(found) else []
    return run([found, *more, "-n", "3", sys.executable, "-m", "mpi4py.futures", SCRIPT, "mpi", *arguments])


def version(launcher):
    return subprocess.run([launcher, "--version"], capture_output=True, check=False).stdout


def test_mpi(tmp_path, quiet, capsys):
    digest = hashlib.sha256(b"".join(quiet)).hexdigest()
    _, plain = mpi(str(tmp_path / "plain"), "quiet")
    assert plain is not None and plain["digest"] == digest and plain["there"] == 0
    # MPI ends the whole job with its first rank; what came before is on the disk, and the same command goes on.
    folder = str(tmp_path / "killed")
    start = time.monotonic()
    done, found = mpi(folder, "kill")
    assert found is None and done.returncode != 0, "the job outlived a killed rank"
    lost = time.monotonic() - start
    done, found = mpi(folder, "again")
    assert found is not None, done.stdout + done.stderr
    assert found["digest"] == digest and 0 < found["there"] < 24, found
    with capsys.disabled():
        print(
            f"\n  MPI, one of two workers killed: the job ended after {lost:.1f} s with {found['there']} of 24 frames "
            f"on disk; begun again, the rest took {found['seconds']:.1f} s ({plain['seconds']:.1f} s undisturbed)"
        )
