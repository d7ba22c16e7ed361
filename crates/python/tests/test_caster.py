"""Rays against arithmetic in numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dotray

EPS = 1e-9


def rays_through(random, count, size=4.0):
    """Rays from all around to points inside."""
    origins = random.normal(size=(count, 3))
    origins *= 3 * size / np.linalg.norm(origins, axis=1, keepdims=True)
    targets = random.random((count, 3)) * size - size / 2
    return np.hstack([origins, targets - origins])


def sphere_crossings(rays, centers, radii):
    """(R, N, 2) t of entering and leaving; NaN where a ray misses."""
    o, d = rays[:, None, :3] - centers[None], rays[:, None, 3:]
    a, b, c = (d * d).sum(-1), (o * d).sum(-1), (o * o).sum(-1) - radii**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(b * b - a * c)
    return np.stack([(-b - root) / a, (-b + root) / a], -1)


def nearest(crossings):
    t = np.where(np.isnan(crossings) | (crossings <= 0), np.inf, crossings).min(-1)
    return t.min(1), t.argmin(1)


@pytest.fixture
def balls(random):
    return random.random((300, 3)) * 4 - 2, random.random(300) * 0.3 + 0.05


def test_spheres_by_brute_force(random, balls):
    centers, radii = balls
    scene = dotray.Scene()
    geometry = scene.add_spheres(centers, radii)
    caster, rays = dotray.RayCaster(scene), rays_through(random, 5000)
    crossings = sphere_crossings(rays, centers, radii)
    t, item = nearest(crossings)
    for coherent in (False, True):
        found = caster.cast_rays(rays, coherent=coherent)
        met = np.isfinite(t)
        assert 0.3 < met.mean() < 1
        assert (np.isfinite(found["t_hit"]) == met).all()
        assert abs(found["t_hit"][met] - t[met]).max() < EPS
        assert (found["primitive_ids"][met] == item[met]).all()
        assert (found["primitive_ids"][~met] == dotray.INVALID_ID).all()
        assert (found["geometry_ids"][met] == geometry).all()
        points = rays[met, :3] + t[met, None] * rays[met, 3:]
        normals = (points - centers[item[met]]) / radii[item[met], None]
        assert abs(found["normals"][met] - normals).max() < 1e-7
        assert (found["normals"][~met] == 0).all()
        assert (caster.occluded(rays, coherent=coherent) == met).all()
        assert (caster.occluded(rays, t_max=0.9, coherent=coherent) == (t < 0.9)).all()
    hits = np.isfinite(crossings).reshape(len(rays), -1)
    assert (caster.count_hits(rays) == hits.sum(1)).all()
    every = caster.all_hits(rays)
    assert (np.diff(every["ray_splits"]) == hits.sum(1)).all() and len(every["t_hit"]) == hits.sum()
    for i in range(0, 5000, 97):
        part = slice(every["ray_splits"][i], every["ray_splits"][i + 1])
        expected = np.sort(crossings[i][np.isfinite(crossings[i])])
        assert (every["ray_ids"][part] == i).all() and np.allclose(every["t_hit"][part], expected, atol=EPS)


def test_single_precision_and_other_layouts_are_the_same_rays(random, balls):
    scene = dotray.Scene()
    scene.add_spheres(*balls)
    caster = dotray.RayCaster(scene)
    rays = rays_through(random, 600).astype(np.float32)
    first = caster.cast_rays(rays)["t_hit"]
    assert (caster.cast_rays(np.asfortranarray(rays.astype(float)))["t_hit"] == first).all()
    found = caster.cast_rays(rays.reshape(20, 30, 6))
    assert found["t_hit"].shape == (20, 30) and found["normals"].shape == (20, 30, 3)
    assert (found["t_hit"].ravel() == first).all() and (found["uvs"].shape == (20, 30, 2))
    assert caster.occluded(rays.reshape(2, 300, 6)).shape == (2, 300)
    bare = caster.cast_rays(rays, surfaces=False)
    assert set(bare) == {"t_hit", "geometry_ids", "primitive_ids"}
    empty = caster.cast_rays(np.zeros((0, 6)))
    assert empty["t_hit"].shape == (0,) and empty["normals"].shape == (0, 3)
    assert caster.all_hits(np.zeros((0, 6)))["ray_splits"].tolist() == [0]


def test_boxes_by_brute_force(random):
    centers, sizes = random.random((100, 3)) * 4 - 2, random.random((100, 3)) * 0.5 + 0.05
    scene = dotray.Scene()
    scene.add_boxes(centers, sizes)
    rays = rays_through(random, 3000)
    low, high = ((centers + side * sizes / 2 - rays[:, None, :3]) / rays[:, None, 3:] for side in (-1, 1))
    enter, leave = np.minimum(low, high).max(-1), np.maximum(low, high).min(-1)
    t = np.where(enter < leave, enter, np.inf)
    found = dotray.RayCaster(scene).cast_rays(rays)
    met = np.isfinite(t.min(1))
    assert (np.isfinite(found["t_hit"]) == met).all() and met.mean() > 0.2
    assert abs(found["t_hit"][met] - t.min(1)[met]).max() < EPS
    assert (found["primitive_ids"] == t.argmin(1))[met].all()


def test_triangles_by_brute_force(random):
    vertices = random.random((60, 3)) * 4 - 2
    faces = np.array([random.choice(60, 3, replace=False) for _ in range(80)])
    scene = dotray.Scene()
    scene.add_triangles(vertices, faces)
    rays = rays_through(random, 3000)
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    d = rays[:, None, 3:]
    p = np.cross(d, c - a)
    det = ((b - a) * p).sum(-1)
    s = rays[:, None, :3] - a
    u = (s * p).sum(-1) / det
    q = np.cross(s, b - a)
    v = (d * q).sum(-1) / det
    t = ((c - a) * q).sum(-1) / det
    t = np.where((u > 0) & (v > 0) & (u + v < 1) & (t > 0), t, np.inf)
    found = dotray.RayCaster(scene).cast_rays(rays)
    met = np.isfinite(t.min(1))
    assert (np.isfinite(found["t_hit"]) == met).all() and met.mean() > 0.3
    assert abs(found["t_hit"][met] - t.min(1)[met]).max() < EPS
    assert (found["primitive_ids"] == t.argmin(1))[met].all()
    normals = np.cross(b - a, c - a)[t.argmin(1)[met]]
    cosines = (found["normals"][met] * normals).sum(1) / np.linalg.norm(normals, axis=1)
    assert abs(cosines - 1).max() < 1e-9, "counter-clockwise is outside"


def distance_to_cone(points, start, end, radius, end_radius):
    """How far points lie outside of a truncated cone, below 0 inside: the maximum of what planes and side say."""
    axis = end - start
    length = np.linalg.norm(axis)
    along = (points - start) @ axis / length
    across = np.linalg.norm(points - start - along[:, None] * axis / length, axis=1)
    width = radius + (end_radius - radius) * along / length
    slant = length / np.hypot(length, radius - end_radius)
    return np.maximum.reduce([-along, along - length, (across - width) * slant])


SHAPES = [("cylinder", 0.4, 0.4), ("cone", 0.6, 0.0), ("apex first", 0.0, 0.6), ("truncated", 0.3, 0.7)]


@pytest.mark.parametrize(("kind", "radius", "end_radius"), SHAPES)
def test_round_shapes_end_where_their_surface_is(kind, radius, end_radius, random):
    for _ in range(12):
        start, end = random.random((2, 3)) * 3 - 1.5
        scene = dotray.Scene()
        if kind == "cylinder":
            scene.add_cylinders(start, end, radius)
        else:
            scene.add_cones(start, end, radius, end_radius)
        caster = dotray.RayCaster(scene)
        rays = rays_through(random, 400, 3.0)
        every = caster.all_hits(rays)
        points = rays[every["ray_ids"], :3] + every["t_hit"][:, None] * rays[every["ray_ids"], 3:]
        assert len(points) > 20
        assert abs(distance_to_cone(points, start, end, radius, end_radius)).max() < 1e-8
        counts = np.diff(every["ray_splits"])
        assert set(counts) <= {0, 2}
        pairs = points[np.repeat(counts, counts) == 2].reshape(-1, 2, 3)
        assert (distance_to_cone(pairs.mean(1), start, end, radius, end_radius) < 1e-9).all(), "convex"
        missed = rays[counts == 0]
        steps = np.linspace(0, 3, 301)[:, None, None]
        along = (missed[None, :, :3] + steps * missed[None, :, 3:]).reshape(-1, 3)
        assert (distance_to_cone(along, start, end, radius, end_radius) > -0.01).all()


def test_open_cylinders_have_no_discs():
    scene = dotray.Scene()
    scene.add_cylinders([0, -1, 0], [0, 1, 0], 0.5, caps=False)
    caster = dotray.RayCaster(scene)
    assert caster.count_hits([[0.1, 5, 0, 0, -1, 0], [5, 0, 0, -1, 0, 0]]).tolist() == [0, 2]
    scene.add_cones([4, -1, 0], [4, 1, 0], 0.5, [0, 0.2], caps=False)
    down, across = [4.05, 5, 0, 0, -1, 0], [9, 0, 0, -1, 0, 0]
    assert dotray.RayCaster(scene).count_hits([down, across]).tolist() == [1, 6], "of the pointed one from above"


def test_geometries_are_numbered_as_they_were_added():
    scene = dotray.Scene()
    group = scene.add_group([[1, 0, 0, 10], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    ids = [
        scene.add_spheres([[0, 0, 0], [0, 3, 0]], 1),
        group.add_boxes([0, 0, 0], 1),
        scene.add_cones([[5, -1, 0]], [[5, 1, 0]], 1),
        group.add_spheres(np.zeros((0, 3)), 1),
        group.add_spheres([[0, 3, 0]], 1),
    ]
    assert ids == [0, 1, 2, 3, 4]
    rays = [[x, y, 9, 0, 0, -1] for x, y in [(0, 0), (0, 3), (10, 0), (5, 0), (10, 3), (3, 9)]]
    found = dotray.RayCaster(scene).cast_rays(rays)
    assert found["geometry_ids"].tolist() == [0, 0, 1, 2, 4, dotray.INVALID_ID]
    assert found["primitive_ids"].tolist() == [0, 1, 0, 0, 0, dotray.INVALID_ID]


def test_a_group_makes_exact_ellipsoids(random):
    scale = np.diag([2.0, 0.5, 1.0, 1.0])
    scene = dotray.Scene()
    scene.add_group(scale).add_spheres([0, 0, 0], 1)
    rays = rays_through(random, 2000)
    squeezed = np.hstack([rays[:, :3], rays[:, 3:]]) / np.tile(np.diag(scale)[:3], 2)
    t, _ = nearest(sphere_crossings(squeezed, np.zeros((1, 3)), np.ones(1)))
    assert np.allclose(dotray.RayCaster(scene).cast_rays(rays)["t_hit"], t, atol=EPS)


finite = st.floats(-50, 50, allow_nan=False, width=32)
point = st.tuples(finite, finite, finite)


@settings(max_examples=150)
@given(st.lists(st.tuples(point, st.floats(0.01, 20)), min_size=1, max_size=12), point, point)
def test_any_ray_any_spheres(spheres, origin, target):
    centers, radii = np.array([s[0] for s in spheres]), np.array([s[1] for s in spheres])
    ray = np.array([*origin, *np.subtract(target, origin)])
    if np.linalg.norm(ray[3:]) < 1e-3:
        return
    scene = dotray.Scene()
    scene.add_spheres(centers, radii)
    caster = dotray.RayCaster(scene)
    crossings = sphere_crossings(ray[None], centers, radii)[0]
    expected = crossings[np.isfinite(crossings) & (crossings > 0)]
    every = caster.all_hits(ray)
    # A ray that only touches a sphere may be told either way.
    if np.isfinite(crossings).all(1).any() and (np.diff(crossings, axis=1) < 1e-6).any():
        return
    depth = np.sort(expected)
    if len(depth) == len(every["t_hit"]):
        scale = 100 / np.linalg.norm(ray[3:])
        assert np.allclose(every["t_hit"], depth, atol=1e-9 * scale)
    else:
        # Only what lies at 0 or touches may differ.
        assert abs(crossings[np.isfinite(crossings)]).min() < 1e-6
    first = caster.cast_rays(ray)
    assert first["t_hit"] == (every["t_hit"][0] if len(every["t_hit"]) else np.inf)
    assert caster.occluded(ray) == bool(len(every["t_hit"])) and caster.count_hits(ray) == len(every["t_hit"])


@settings(max_examples=60)
@given(st.integers(0, 2**32), st.integers(1, 60), st.booleans())
def test_any_arrays_make_a_picture(seed, count, single):
    random = np.random.default_rng(seed)
    kind = np.float32 if single else np.float64
    starts, ends = random.normal(size=(2, count, 3)).astype(kind)
    scene = dotray.Scene()
    scene.add_cylinders(starts, ends, random.random(count) * 0.1 + 0.01, color=random.random((count, 3)))
    scene.add_cones(starts, ends, random.random(count), random.random(count) + 0.01)
    pixels = scene.render(24, 16).numpy()
    assert np.isfinite(pixels).all()
    assert scene.shape_count == 2 * count
