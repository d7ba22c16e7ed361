"""Ten million spheres from numpy to a picture of 1024 × 768 with shadows: dotray, OVITO and Tachyon side by side.

    python spheres.py all [COUNT]                   every program that is there, one process each, one thread each
    python spheres.py dotray|ovito-tachyon|ovito-ospray|tachyon COUNT THREADS

Spheres are uniform in the unit cube, N π r² = 2 with radii up to a quarter more or less, coloured one by one, lit by a
directional light. OVITO comes by `pip install ovito`, Tachyon by `apt-get install tachyon-bin-nox`; the latter reads
arrays from text only, so its seconds include that. Prints a line of JSON for each program: CPU and wall seconds from
arrays in memory to the picture's file, and the peak of memory in MB, the arrays included.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SIZE = (1024, 768)
EYE, TARGET, UP, ANGLE = (1.9, 1.3, 2.4), (0.5, 0.45, 0.5), (0.0, 1.0, 0.0), 0.27
LIGHT = (-0.4, -0.8, -0.5)


def spheres(count):
    random = np.random.default_rng(count)
    centers = random.random((count, 3), dtype=np.float32)
    radii = np.float32(math.sqrt(2 / (math.pi * count))) * (0.75 + 0.5 * random.random(count, dtype=np.float32))
    return centers, radii, random.random((count, 3), dtype=np.float32)


def with_dotray(count, threads, out):
    import dotray

    centers, radii, colors = spheres(count)
    start = time.perf_counter(), time.process_time()
    scene = dotray.Scene(background="black", ambient=(0.2, 0.2, 0.2))
    scene.look_at(EYE, TARGET, UP, ANGLE)
    scene.lights = [dotray.DirectionalLight(LIGHT)]
    scene.add_spheres(centers, radii, color=colors)
    scene.render(*SIZE, threads=threads, progress=False).save(out)
    return start


def with_ovito(count, threads, out, engine):
    os.environ["OVITO_THREAD_COUNT"] = os.environ["OSPRAY_NUM_THREADS"] = str(threads)
    from ovito.data import DataCollection
    from ovito.pipeline import Pipeline, StaticSource
    from ovito.vis import OSPRayRenderer, TachyonRenderer, Viewport

    centers, radii, colors = spheres(count)
    start = time.perf_counter(), time.process_time()
    data = DataCollection()
    particles = data.create_particles(count=count)
    particles.create_property("Position", data=centers)
    particles.create_property("Radius", data=radii)
    particles.create_property("Color", data=colors)
    Pipeline(source=StaticSource(data=data)).add_to_scene()
    way = np.subtract(TARGET, EYE)
    view = Viewport(
        type=Viewport.Type.Perspective,
        fov=2 * ANGLE,
        camera_pos=EYE,
        camera_dir=way / np.linalg.norm(way),
        camera_up=UP,
    )
    if engine == "tachyon":
        renderer = TachyonRenderer(ambient_occlusion=False, antialiasing=False, shadows=True, direct_light=True)
    else:
        renderer = OSPRayRenderer(samples_per_pixel=1, refinement_iterations=1, denoising_enabled=False)
        renderer.ambient_light_enabled, renderer.direct_light_enabled = False, True
        # A small sun, as bright as the others' lights.
        renderer.direct_light_intensity, renderer.direct_light_angular_diameter = 5.0, 0.0
    view.render_image(size=SIZE, filename=str(out), background=(0, 0, 0), renderer=renderer)
    return start


def with_tachyon(count, threads, out):
    centers, radii, colors = spheres(count)
    start = time.perf_counter(), time.process_time()
    way = np.subtract(TARGET, EYE)
    way = way / np.linalg.norm(way)
    up = np.subtract(UP, np.dot(UP, way) * way)
    up = up / np.linalg.norm(up)
    numbers = " ".join
    with tempfile.NamedTemporaryFile("w", suffix=".dat", delete=False) as text:
        text.write(
            f"BEGIN_SCENE\nRESOLUTION {SIZE[0]} {SIZE[1]}\n"
            f"CAMERA\n ZOOM {0.5 / math.tan(ANGLE):.9g}\n ASPECTRATIO 1.0\n ANTIALIASING 0\n RAYDEPTH 5\n "
            f"CENTER {numbers(map(str, EYE))}\n VIEWDIR {numbers(map(str, way))}\n "
            f"UPDIR {numbers(map(str, up))}\nEND_CAMERA\nBACKGROUND 0 0 0\n"
            f"DIRECTIONAL_LIGHT DIRECTION {numbers(map(str, LIGHT))} COLOR 1 1 1\n"
        )
        # One of 512 colours: a texture for each sphere would not fit.
        shades = (colors * 7.999).astype(np.int64) @ [64, 8, 1]
        for shade in range(512):
            red, green, blue = shade // 64 / 7, shade // 8 % 8 / 7, shade % 8 / 7
            text.write(
                f"TEXDEF T{shade} AMBIENT 0.2 DIFFUSE 1 SPECULAR 0 OPACITY 1 COLOR {red} {green} {blue} TEXFUNC 0\n"
            )
        line = "SPHERE CENTER %.7g %.7g %.7g RAD %.7g T%d\n"
        for first in range(0, count, 100_000):
            part = slice(first, first + 100_000)
            rows = np.column_stack([centers[part], radii[part], shades[part]])
            text.write((line * len(rows)) % tuple(rows.ravel()))
        text.write("END_SCENE\n")
    del centers, radii, colors, shades
    begun = time.perf_counter()
    subprocess.run(
        ["tachyon", text.name, "-fullshade", "-numthreads", str(threads), "-format", "BMP", "-o", str(out)],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    os.unlink(text.name)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return begun, used.ru_utime + used.ru_stime, used.ru_maxrss, start


def main():
    program, *rest = sys.argv[1:]
    count = int(float(rest[0])) if rest else 10_000_000
    if program == "all":
        for name in ["dotray", "ovito-ospray", "ovito-tachyon", "tachyon"]:
            done = subprocess.run(
                [sys.executable, __file__, name, str(count), "1"], capture_output=True, text=True, check=False
            )
            print(done.stdout.strip().splitlines()[-1] if done.returncode == 0 else f"{name}: {done.stderr[-300:]}")
            sys.stdout.flush()
        return
    threads = int(rest[1]) if len(rest) > 1 else 1
    if threads == 1 and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    name = f"spheres-{program}.{'bmp' if program == 'tachyon' else 'png'}"
    out = Path(os.environ.get("OUT", tempfile.gettempdir()), name)
    told = {"program": program, "spheres": count, "threads": threads}
    if program == "tachyon":
        begun, cpu, peak, _ = with_tachyon(count, threads, out)
        told |= {"cpu_s": cpu, "wall_s": time.perf_counter() - begun, "peak_MB": peak * 1024 / 1e6}
    else:
        if program == "dotray":
            wall, cpu = with_dotray(count, threads, out)
        else:
            wall, cpu = with_ovito(count, threads, out, program.split("-")[1])
        told |= {"cpu_s": time.process_time() - cpu, "wall_s": time.perf_counter() - wall}
        told["peak_MB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    print(json.dumps({key: round(value, 2) if isinstance(value, float) else value for key, value in told.items()}))


if __name__ == "__main__":
    main()
