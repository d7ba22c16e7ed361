"""A host that is lost, and a cable that is pulled, in the middle of a film: run by `test_cluster.py` as
`unshare -n -m -p -f --mount-proc python many_hosts.py HOW FOLDER`. Prints what it found as JSON."""

import json
import sys
import time

import numpy as np
from engines import Dask, Network

import dotray
from dotray import cluster


def scene():
    random = np.random.default_rng(1)
    made = dotray.Scene()
    made.add_spheres(random.random((3000, 3)), 0.03, color=random.random((3000, 3)))
    return made


def film(executor, folder, middle=None, **options):
    """Frames' bytes and the seconds they took; `middle` is called when a quarter has come."""
    angles = np.linspace(0, 1, 24, endpoint=False)
    cameras = [dotray.Camera.look_at((4 * np.sin(a) + 0.5, 0.5, 4 * np.cos(a) + 0.5), (0.5, 0.5, 0.5)) for a in angles]
    fired = []

    def watch(record):
        if middle is not None and not fired and 4 * record["finished_pixels"] >= record["total_pixels"]:
            fired.append(time.monotonic())
            middle()

    start = time.monotonic()
    paths = cluster.frames(
        scene(), cameras, f"{folder}/{{:02d}}.png", 160, 120, aa=6, executor=executor, progress=watch, **options
    )
    taken = time.monotonic() - start
    assert middle is None or fired
    return [path.read_bytes() for path in paths], taken


def main():
    how, folder = sys.argv[1:]
    network = Network()
    with Dask("10.77.0.1") as dask:
        hosts = [network.add_worker(dask) for _ in range(3)]
        client = dask.client(3)
        quiet, quiet_seconds = film(client, f"{folder}/quiet")
        process, cable = hosts[1]

        def lose():
            network.pull(cable)
            if how == "host":
                process.kill()

        disturbed, seconds = film(client, f"{folder}/disturbed", lose, patience=5.0)
        same = [dotray.Image.open(f"{folder}/quiet/{i:02d}.png").numpy().tolist() for i in (0, 23)]
        assert same[0] != same[1]
        print(json.dumps({"same": quiet == disturbed, "quiet": quiet_seconds, "disturbed": seconds}), flush=True)


if __name__ == "__main__":
    main()
