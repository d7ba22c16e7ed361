"""Dask's own scheduler and workers as processes of their own, on one host or on hosts that are network namespaces."""

import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

from dotray import _pieces

HERE = str(Path(__file__).parent)

SETTINGS = {
    # A worker that has not been heard of for so long counts as lost.
    "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "10s",
    "DASK_DISTRIBUTED__LOGGING__DISTRIBUTED": "critical",
    "PYTHONWARNINGS": "ignore",
}


class Process:
    """A process in a session of its own, which ends with all that it started."""

    def __init__(self, *command):
        self.process = subprocess.Popen(
            command,
            env={**os.environ, **SETTINGS, "PYTHONPATH": os.pathsep.join([HERE, os.environ.get("PYTHONPATH", "")])},
            start_new_session=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    @property
    def pid(self):
        return self.process.pid

    def kill(self):
        """SIGKILL for it and everything that it started, as when a host is lost."""
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def worker_command(address, *options):
    command = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard"]
    return [*command, "--death-timeout", "120", *options]


class Dask(ExitStack):
    """A scheduler; workers are added."""

    def __init__(self, host="127.0.0.1"):
        super().__init__()
        self.address = f"tcp://{host}:{free_port()}"
        command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--no-dashboard"]
        port = self.address.rsplit(":", 1)[1]
        self.enter_context(Process(*command, "--host", host, "--port", port))

    def add_worker(self, *options):
        """A worker on this host."""
        return self.enter_context(Process(*worker_command(self.address, *options)))

    def client(self, workers):
        """A client, once so many workers are there."""
        import dask
        from distributed import Client

        dask.config.set({"distributed.logging.distributed": "critical"})
        deadline = time.monotonic() + 120
        while True:
            try:
                client = self.enter_context(Client(self.address, timeout=10, set_as_default=False))
                break
            except OSError:
                if time.monotonic() > deadline:
                    raise
        client.wait_for_workers(workers, timeout=120)
        return client


def run(*command):
    subprocess.run(command, check=True, capture_output=True)


class Network:
    """Hosts that are network namespaces, each on a cable to one switch; for a process in a namespace of its own."""

    def __init__(self, dask_host="10.77.0.1"):
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "switch", "type", "bridge")
        run("ip", "addr", "add", f"{dask_host}/24", "dev", "switch")
        run("ip", "link", "set", "switch", "up")
        self.hosts = 1

    def add_host(self, stack, command):
        """A host that runs a command, in which HOST stands for its address: its process, and the name of its cable."""
        self.hosts += 1
        host, cable = f"10.77.0.{self.hosts}", f"cable{self.hosts}"
        inside = (
            "for i in $(seq 100); do ip link show eth0 >/dev/null 2>&1 && break; sleep 0.05; done; "
            f"ip link set lo up; ip addr add {host}/24 dev eth0; ip link set eth0 up; exec "
        )
        command = inside + " ".join(command).replace("HOST", host)
        process = stack.enter_context(Process("unshare", "-n", "sh", "-c", command))
        time.sleep(0.3)
        run("ip", "link", "add", cable, "type", "veth", "peer", "name", "eth0", "netns", str(process.pid))
        run("ip", "link", "set", cable, "master", "switch")
        run("ip", "link", "set", cable, "up")
        return process, cable

    def add_worker(self, dask):
        """A host with one of Dask's workers."""
        return self.add_host(dask, worker_command(dask.address, "--host", "HOST"))

    @staticmethod
    def pull(cable):
        """Nothing comes through any more, and nobody is told."""
        run("ip", "link", "set", cable, "down")


def count_loads():
    """From now on this worker counts how often it unpacks a scene."""
    _pieces._loads = 0

    class Counting:
        @staticmethod
        def loads(content):
            _pieces._loads += 1
            return pickle.loads(content)

    _pieces.pickle = Counting


def loads_so_far():
    _pieces.pickle = pickle
    return _pieces._loads
