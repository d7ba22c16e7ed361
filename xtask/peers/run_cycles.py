"""run_cycles.py SPHERES.sph CAMERA.cam THREADS ROUNDS (a Python with bpy)

Cycles on the CPU for spheres in memory: a point cloud, a sun, eye and shadow rays only, one sample a pixel, no
denoising. Prints what `from_memory` prints."""
import sys
import time

import bpy
import numpy as np
from mathutils import Vector

spheres, camera_file, threads, rounds = sys.argv[1:]
s = np.fromfile(spheres, np.float32).reshape(-1, 4)
c = [float(word) for word in open(camera_file).read().split()]
for _ in range(int(rounds)):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    cpu, wall = time.process_time(), time.monotonic()
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.pixel_filter_type = "CPU", 1, "BOX"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.max_bounces = cycles.diffuse_bounces = 0
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 1024, 768, 100
    scene.render.threads_mode, scene.render.threads = "FIXED", int(threads)

    cloud = bpy.data.pointclouds.new("spheres")
    cloud.resize(len(s))
    cloud.attributes["position"].data.foreach_set("vector", s[:, :3].ravel())
    radius = cloud.attributes.get("radius") or cloud.attributes.new("radius", "FLOAT", "POINT")
    radius.data.foreach_set("value", s[:, 3].copy())
    thing = bpy.data.objects.new("spheres", cloud)
    material = bpy.data.materials.new("diffuse")
    material.use_nodes = True
    nodes = material.node_tree
    nodes.nodes.clear()
    output = nodes.nodes.new("ShaderNodeOutputMaterial")
    nodes.links.new(nodes.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], output.inputs[0])
    thing.data.materials.append(material)
    scene.collection.objects.link(thing)

    camera = bpy.data.cameras.new("camera")
    eye = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(eye)
    scene.camera = eye
    eye.location = c[0:3]
    eye.rotation_euler = (Vector(c[3:6]) - Vector(c[0:3])).to_track_quat("-Z", "Y").to_euler()
    camera.sensor_fit, camera.angle_y, camera.clip_end = "VERTICAL", np.radians(c[9]), 1000
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = 3, 0
    sun = bpy.data.objects.new("sun", light)
    sun.rotation_euler = (Vector(c[3:6]) - Vector(c[10:13])).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(sun)
    bpy.ops.render.render(write_still=False)
    print(f"PICTURE,{time.process_time() - cpu:.4f},{time.monotonic() - wall:.4f}", flush=True)
