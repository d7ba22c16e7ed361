"""The OpenCue recipes of docs/machines.md with pyoutline and RQD as they are published: `opencue.py PAGE HOW`, where HOW
is outline or command, in a folder with a plan of 16 pieces, `dotray` on the path. The server between the two, Cuebot,
is in no registry: a stand-in speaks its protocol. It takes the job that the outline launches, hands every frame to RQD,
and hands out again what failed, as Cuebot would; some programs are killed in their midst. Prints how many were run."""

import os
import queue
import re
import signal
import socket
import subprocess
import sys
import time
from concurrent import futures
from pathlib import Path
from xml.etree import ElementTree

import grpc
from opencue_proto import cue_pb2, cue_pb2_grpc, job_pb2, job_pb2_grpc, report_pb2, report_pb2_grpc, rqd_pb2
from opencue_proto import rqd_pb2_grpc

# Whoever runs the frames may be anybody but root.
USER, UID = "nobody", 65534


class Cuebot(
    job_pb2_grpc.JobInterfaceServicer, report_pb2_grpc.RqdReportInterfaceServicer, cue_pb2_grpc.CueInterfaceServicer
):
    """What of Cuebot a job of one layer meets."""

    def __init__(self):
        self.specs = queue.Queue()
        self.boots = queue.Queue()
        self.ended = queue.Queue()

    def GetSystemStats(self, request, context):
        return cue_pb2.CueGetSystemStatsResponse()

    def LaunchSpecAndWait(self, request, context):
        self.specs.put(request.spec)
        name = ElementTree.fromstring(request.spec).find("job").get("name")
        jobs = job_pb2.JobSeq(jobs=[job_pb2.Job(id="1", name=name)])
        return job_pb2.JobLaunchSpecAndWaitResponse(jobs=jobs)

    def ReportRqdStartup(self, request, context):
        self.boots.put(request.boot_report)
        return report_pb2.RqdReportRqdStartupResponse()

    def ReportStatus(self, request, context):
        return report_pb2.RqdReportStatusResponse()

    def ReportRunningFrameCompletion(self, request, context):
        self.ended.put(request.frame_complete_report)
        return report_pb2.RqdReportRunningFrameCompletionResponse()


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def recipe(page, language):
    """What the page says; only the folder is this one."""
    section = page.split("## OpenCue", 1)[1].split("\n## ", 1)[0]
    block = re.search(rf"```{language}\n(.*?)```", section, re.DOTALL).group(1)
    assert "/data" in block
    return block.replace("/data", str(Path.cwd()))


def run_frame(layer, number, attempt):
    """What Cuebot tells RQD of a frame: the number goes into the command and into the environment."""
    name = f"{number:04d}-{layer.get('name')}"
    command = layer.find("cmd").text.replace("#ZFRAME#", f"{number:04d}").replace("#IFRAME#", str(number))
    frame = rqd_pb2.RunFrame(
        resource_id=f"resource-{number}",
        job_id="1",
        job_name="room",
        frame_id=f"frame-{number}-{attempt}",
        frame_name=name,
        layer_id="1",
        command=command,
        user_name=USER,
        uid=UID,
        gid=UID,
        log_dir=os.path.abspath("logs"),
        show="testing",
        shot="default",
        job_temp_dir="",
        frame_temp_dir="",
        num_cores=100,
    )
    frame.environment.update({"CUE_IFRAME": str(number), "CUE_FRAME": name, "CUE_JOB": "room", "CUE_LAYER": "work"})
    return frame


def frames(layer):
    first, last = map(int, layer.find("range").text.split("-"))
    return range(first, last + 1)


def dispatch(layer, rqd, cuebot, cores):
    """Runs every frame of the layer, so many at once; how often frames were run, and killed."""
    waiting = [(number, 0) for number in frames(layer)]
    most = int(os.environ.get("MAXRETRIES", "2"))
    running, runs, killed = {}, 0, 0
    while waiting or running:
        while waiting and len(running) < cores:
            number, attempt = waiting.pop(0)
            frame = run_frame(layer, number, attempt)
            rqd.LaunchFrame(rqd_pb2.RqdStaticLaunchFrameRequest(run_frame=frame))
            running[frame.frame_id] = (number, attempt)
            runs += 1
            if attempt == 0 and number % 7 == 2:
                killed += kill(number)
        report = cuebot.ended.get(timeout=60)
        number, attempt = running.pop(report.frame.frame_id)
        if report.exit_status:
            log = "".join(path.read_text() for path in Path("logs").glob(f"*{number:04d}-*.rqlog"))
            assert attempt < most, f"frame {number} failed {attempt + 1} times:\n{log}"
            waiting.append((number, attempt + 1))
    assert killed, "nothing was killed"
    return runs, killed


def kill(number):
    """SIGKILL for the program of a frame; true where it was there in time. RQD itself is not asked: where the frame has
    not begun yet, it would end the group of processes that it is in."""
    for _ in range(400):
        for process in Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes().split(b"\0")
                variables = (process / "environ").read_bytes().split(b"\0")
            except OSError:
                continue
            if words[0].endswith(b"dotray") and f"CUE_IFRAME={number}".encode() in variables:
                os.kill(int(process.name), signal.SIGKILL)
                return True
        time.sleep(0.002)
    return False


def main():
    path, way = sys.argv[1:]
    page, here = Path(path).read_text(encoding="utf-8"), Path.cwd()
    (here / "logs").mkdir()
    cuebot, port, own_port = Cuebot(), free_port(), free_port()
    server = grpc.server(futures.ThreadPoolExecutor(8))
    job_pb2_grpc.add_JobInterfaceServicer_to_server(cuebot, server)
    cue_pb2_grpc.add_CueInterfaceServicer_to_server(cuebot, server)
    report_pb2_grpc.add_RqdReportInterfaceServicer_to_server(cuebot, server)
    server.add_insecure_port(f"127.0.0.1:{port}")
    server.start()
    config = {
        "RQD_GRPC_PORT": own_port,
        "CUEBOT_GRPC_PORT": port,
        "OVERRIDE_CUEBOT": "127.0.0.1",
        "OVERRIDE_HOSTNAME": "localhost",
        "OVERRIDE_NIMBY": "False",
        "OVERRIDE_CORES": 2,
        "OVERRIDE_MEMORY": 4_000_000,
        "RQD_USE_PATH_ENV_VAR": "True",
    }
    (here / "rqd.conf").write_text("[Override]\n" + "".join(f"{name}={value}\n" for name, value in config.items()))
    # The page's outline, as a user launches it.
    (here / "room.outline.py").write_text(recipe(page, "python"))
    environment = {**os.environ, "HOME": str(here), "CUEBOT_HOSTS": f"127.0.0.1:{port}"}
    subprocess.run([sys.executable, "room.outline.py"], check=True, env=environment, stdout=subprocess.DEVNULL)
    layers = ElementTree.fromstring(cuebot.specs.get(timeout=10)).findall("job/layers/layer")
    assert len(layers) == 1, layers
    if way == "command":
        layers[0].find("cmd").text = recipe(page, "sh")
    with open(here / "rqd.log", "wb") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "rqd", "-c", "rqd.conf", "--nimbyoff"], env=environment, stdout=log, stderr=log,
            start_new_session=True,
        )
    try:
        boot = cuebot.boots.get(timeout=60)
        rqd = rqd_pb2_grpc.RqdInterfaceStub(grpc.insecure_channel(f"127.0.0.1:{own_port}"))
        runs, killed = dispatch(layers[0], rqd, cuebot, max(1, boot.core_info.total_cores // 100))
        print(f"{runs} frames were run, {killed} of them killed")
    finally:
        process.kill()
        process.wait()
        server.stop(0)


if __name__ == "__main__":
    main()
