"""Ray's and MPI's own schedulers and workers, one of which is killed in the middle of a film: run by `test_engines.py`
as `python more_engines.py ray FOLDER` in a namespace of its own, and as
`mpiexec -n 3 python -m mpi4py.futures more_engines.py mpi FOLDER [kill]`. Prints what it found as JSON."""

import json
import os
import signal
import sys
import time
from pathlib import Path

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


def _slowly(_):
    time.sleep(0.05)
    return os.getpid()


def main():
    engine, folder, *how = sys.argv[1:]
    found = with_ray(folder) if engine == "ray" else with_mpi(folder, *how)
    print("\n" + json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
