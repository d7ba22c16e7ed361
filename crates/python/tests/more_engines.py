"""Ray's and MPI's own schedulers and workers, one of which is killed in the middle of a film: run by `test_engines.py`
as `python more_engines.py ray FOLDER`, ray-cable or mpi-cable in namespaces of its own, and as
`mpiexec -n 3 python -m mpi4py.futures more_engines.py mpi FOLDER [kill]`. Prints what it found as JSON."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from engines import Network, Process
from many_hosts import film, scene


def with_ray(folder):
    """A worker of a node is killed, then a whole node of two."""
    import ray
    from ray.cluster_utils import Cluster

    from dotray import cluster

    found = {}
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    second = nodes.add_node(num_cpus=1)
    ray.init(address=nodes.address, log_to_driver=False)
    nodes.wait_for_nodes()
    executor = cluster.RayExecutor()
    film(executor, f"{folder}/warm")
    quiet, found["quiet"] = film(executor, f"{folder}/quiet")
    alone = scene().render(200, 150, aa="adaptive", layers=["depth", "normal"])
    spread = scene().render(200, 150, aa="adaptive", layers=["depth", "normal"], executor=executor)
    found["picture"] = bool((alone.numpy() == spread.numpy()).all())
    found["layers"] = bool((alone.layers["depth"] == spread.layers["depth"]).all())

    def kill_worker():
        workers = {executor.submit(os.getpid).result() for _ in range(4)}
        os.kill(workers.pop(), signal.SIGKILL)

    disturbed, found["worker"] = film(executor, f"{folder}/worker", kill_worker)
    found["same"] = quiet == disturbed

    def kill_node():
        nodes.remove_node(second, allow_graceful=False)

    disturbed, found["node"] = film(executor, f"{folder}/node", kill_node, patience=5.0)
    found["same"] = found["same"] and quiet == disturbed
    ray.shutdown()
    nodes.shutdown()
    return found


def with_cable(folder):
    """The cable of one of two hosts with workers is pulled."""
    import ray

    from dotray import cluster

    # By itself Ray gives a host that is silent half a minute, and its connections minutes.
    os.environ.update(
        RAY_health_check_initial_delay_ms="0",
        RAY_health_check_period_ms="1000",
        RAY_health_check_timeout_ms="1000",
        RAY_health_check_failure_threshold="3",
        RAY_grpc_client_keepalive_time_ms="1000",
        RAY_grpc_client_keepalive_timeout_ms="2000",
        RAY_grpc_keepalive_time_ms="1000",
        RAY_grpc_keepalive_timeout_ms="2000",
    )
    network = Network()
    here, start = "10.77.0.1:6379", [str(Path(sys.executable).with_name("ray")), "start", "--block"]
    with ExitStack() as stack:
        # Sockets have short names only.
        files = stack.enter_context(tempfile.TemporaryDirectory(prefix="ray", dir="/tmp", ignore_cleanup_errors=True))
        head = ["--head", "--node-ip-address=10.77.0.1", "--port=6379", f"--temp-dir={files}"]
        stack.enter_context(Process(*start, *head, "--num-cpus=0", "--include-dashboard=false"))
        # The hosts share one disk, and in one folder two that start at once would take the same names of sockets.
        own = f"--temp-dir={files}/HOST"
        worker = [*start, f"--address={here}", "--node-ip-address=HOST", "--num-cpus=1", own]
        cables = [network.add_host(stack, worker)[1] for _ in range(2)]
        connect(ray, here)
        executor = cluster.RayExecutor()
        film(executor, f"{folder}/warm")
        quiet, quiet_seconds = film(executor, f"{folder}/quiet")
        disturbed, seconds = film(executor, f"{folder}/cable", lambda: network.pull(cables[0]), patience=5.0)
        return {"same": quiet == disturbed, "quiet": quiet_seconds, "cable": seconds}


def connect(ray, address):
    """Becomes a driver once the head and both workers are there."""
    deadline = time.monotonic() + 90
    while True:
        try:
            if not ray.is_initialized():
                ray.init(address=address, _node_ip_address="10.77.0.1", log_to_driver=False)
            if ray.cluster_resources().get("CPU") == 2:
                return
        except Exception:
            if time.monotonic() > deadline:
                raise
        assert time.monotonic() < deadline, "no workers"
        time.sleep(0.5)


def with_mpi(folder, how):
    """All workers stay; or one is killed, which ends them all, and the same work goes on after that."""
    from mpi4py.futures import MPIPoolExecutor

    pieces = Path(folder, "pieces")
    with MPIPoolExecutor() as executor:
        pids = set(executor.map(_slowly, range(8)))
        middle = (lambda: os.kill(pids.pop(), signal.SIGKILL)) if how == "kill" else None
        start = time.monotonic()
        there = len(list(pieces.glob("*.tiles")))
        frames, _ = film(executor, f"{folder}/{how}", middle, directory=pieces, resume=False)
        taken = time.monotonic() - start
    import hashlib

    digest = hashlib.sha256(b"".join(frames)).hexdigest()
    return {"frames": len(frames), "digest": digest, "seconds": taken, "there": there}


def with_mpi_cable(folder):
    """The cable of one of two hosts with ranks is pulled. MPI itself waits for that host for ever, and is ended here."""
    network = Network()
    with ExitStack() as stack:
        hosts = [network.add_host(stack, ["sleep", "600"]) for _ in range(2)]
        for process, _ in hosts:
            ready = ["nsenter", "-t", str(process.pid), "-n", "sh", "-c"]
            subprocess.run([*ready, "until ip route | grep -q 10.77; do sleep 0.1; done"], check=True, timeout=30)
        # In place of ssh: a host is a network namespace.
        cases = "".join(f"10.77.0.{n}) pid={process.pid};;\n" for n, (process, _) in enumerate(hosts, 2))
        enter = Path(folder, "enter")
        enter.write_text(
            f'#!/bin/sh\n[ "$1" = -x ] && shift\nhost=$1; shift\ncase $host in\n{cases}esac\n'
            'exec nsenter -t $pid -n sh -c "$*"\n'
        )
        enter.chmod(0o755)
        launcher = [str(Path(sys.executable).with_name("mpiexec")), "-launcher", "ssh", "-launcher-exec", str(enter)]
        ranks = ["-hosts", "10.77.0.1,10.77.0.2,10.77.0.3", "-n", "3"]
        script = [sys.executable, "-m", "mpi4py.futures", __file__, "mpi-cabled", folder, hosts[0][1]]
        # Through the network, although all of them are one machine.
        variables = {"MPIR_CVAR_CH4_NETMOD": "ofi", "FI_PROVIDER": "tcp", "MPIR_CVAR_NOLOCAL": "1"}
        job = subprocess.Popen(
            [*launcher, *ranks, *script], env={**os.environ, **variables}, stdout=subprocess.PIPE, text=True
        )
        try:
            return next(json.loads(line) for line in job.stdout if line.startswith("{"))
        finally:
            job.kill()


def mpi_cabled(folder, cable):
    """The first rank of the job, which pulls the cable of another one."""
    from mpi4py.futures import MPIPoolExecutor

    executor = MPIPoolExecutor()
    quiet, quiet_seconds = film(executor, f"{folder}/quiet")
    disturbed, seconds = film(executor, f"{folder}/cable", lambda: Network.pull(cable), patience=5.0)
    print(json.dumps({"same": quiet == disturbed, "quiet": quiet_seconds, "cable": seconds}), flush=True)
    os._exit(0)


def _slowly(_):
    time.sleep(0.05)
    return os.getpid()


def main():
    engine, folder, *how = sys.argv[1:]
    engines = {
        "ray": with_ray,
        "ray-cable": with_cable,
        "mpi": with_mpi,
        "mpi-cable": with_mpi_cable,
        "mpi-cabled": mpi_cabled,
    }
    print("\n" + json.dumps(engines[engine](folder, *how)), flush=True)
    if engine.endswith("-cable"):
        # Ray and MPI would wait for the host that is not there.
        os._exit(0)


if __name__ == "__main__":
    main()
