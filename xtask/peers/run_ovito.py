"""run_ovito.py tachyon|ospray SPHERES.sph CAMERA.cam THREADS ROUNDS

OVITO's renderers for spheres in memory: one directional light, shadows, no ambient occlusion. Prints what
`from_memory` prints; the first picture includes everything that OVITO does once."""
import os
import sys
import time

engine, spheres, camera, threads, rounds = sys.argv[1:]
os.environ["OVITO_THREAD_COUNT"] = os.environ["OSPRAY_NUM_THREADS"] = threads
if threads == "1" and hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {0})

import numpy as np
from ovito.data import DataCollection
from ovito.pipeline import Pipeline, StaticSource
from ovito.vis import OSPRayRenderer, TachyonRenderer, Viewport

s = np.fromfile(spheres, np.float32).reshape(-1, 4)
c = [float(word) for word in open(camera).read().split()]
direction = np.array(c[3:6]) - np.array(c[0:3])
for _ in range(int(rounds)):
    cpu, wall = time.process_time(), time.monotonic()
    data = DataCollection()
    particles = data.create_particles(count=len(s))
    particles.create_property("Position", data=s[:, :3])
    particles.create_property("Radius", data=s[:, 3])
    pipeline = Pipeline(source=StaticSource(data=data))
    pipeline.add_to_scene()
    viewport = Viewport(type=Viewport.Type.Perspective, fov=np.radians(c[9]), camera_pos=c[0:3],
                        camera_dir=direction / np.linalg.norm(direction), camera_up=c[6:9])
    if engine == "tachyon":
        renderer = TachyonRenderer(ambient_occlusion=False, antialiasing=False, shadows=True, direct_light=True)
    else:
        renderer = OSPRayRenderer(samples_per_pixel=1, refinement_iterations=1, denoising_enabled=False,
                                  ambient_light_enabled=False, direct_light_enabled=True)
    viewport.render_image(size=(1024, 768), renderer=renderer)
    print(f"PICTURE,{time.process_time() - cpu:.4f},{time.monotonic() - wall:.4f}", flush=True)
    pipeline.remove_from_scene()
