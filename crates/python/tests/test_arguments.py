"""Faulty arguments: a ValueError that names the argument, the index and the value."""

import re

import numpy as np
import pytest

import dotray

NAN = float("nan")
POINTS = [[0, 0, 0], [1, 0, 0]]


def faults():
    scene = dotray.Scene
    yield "centers[1, 2] is nan", lambda: scene().add_spheres([[0, 0, 0], [0, 0, NAN]], 1)
    yield "centers[0, 0] is inf", lambda: scene().add_spheres(np.array([[np.inf, 0, 0]], np.float32), 1)
    yield "centers has shape (2, 2): expected (N, 3)", lambda: scene().add_spheres([[0, 0], [1, 1]], 1)
    yield "centers has dtype complex128", lambda: scene().add_spheres(np.zeros((2, 3), complex), 1)
    yield "centers has dtype <U1", lambda: scene().add_spheres([["a", "b", "c"]], 1)
    yield "centers is no array of numbers", lambda: scene().add_spheres([[0, 0, 0], [1]], 1)
    yield "radii[1] is -1.0: expected a number above 0", lambda: scene().add_spheres(POINTS, [1, -1])
    yield "radii[0] is 0.0", lambda: scene().add_spheres(POINTS, [0.0, 1])
    yield "radii is -2.0: expected", lambda: scene().add_spheres(POINTS, -2)
    yield "centers has 2 rows, radii has 3", lambda: scene().add_spheres(POINTS, [1, 1, 1])
    yield "radii has shape (2, 2)", lambda: scene().add_spheres(POINTS, [[1, 1], [1, 1]])
    yield "centers has 2 rows, radii has 1, color has 3", lambda: scene().add_spheres(POINTS, 1, color=np.zeros((3, 3)))
    yield (
        "color has shape (2, 4): expected (N, 3); leave alpha",
        lambda: scene().add_spheres(POINTS, 1, color=np.zeros((2, 4))),
    )
    yield "color is 'rot'", lambda: scene().add_spheres(POINTS, 1, color="rot")
    yield "color is '#12345g'", lambda: scene().add_spheres(POINTS, 1, color="#12345g")
    yield "color[1, 0] is nan", lambda: scene().add_spheres(POINTS, 1, color=[[0, 0, 0], [NAN, 0, 0]])
    yield "color[0, 1] is inf", lambda: scene().add_spheres(POINTS, 1, color=[[0, 1e300, 0], [0, 0, 0]])
    yield (
        "ends[1] is [1.0, 0.0, 0.0], which is starts[1], too",
        lambda: scene().add_cylinders(POINTS, [[0.0, 1, 0], [1, 0, 0]], 1),
    )
    yield "radii[0] and end_radii[0] are 0", lambda: scene().add_cones(POINTS, [0.5, 1, 0], 0, 0)
    yield (
        "end_radii[1] is -0.5: expected a number of 0 or more",
        lambda: scene().add_cones(POINTS, [0.5, 1, 0], 1, [0, -0.5]),
    )
    yield "sizes[1, 1] is 0.0", lambda: scene().add_boxes(POINTS, [[1, 1, 1], [1, 0, 1]])
    yield (
        "faces[1, 2] is 7: expected the number of one of 2 vertices",
        lambda: scene().add_triangles(POINTS, [[0, 1, 0], [0, 1, 7]]),
    )
    yield "faces[0, 0] is -1", lambda: scene().add_triangles(POINTS, [[-1, 0, 1]])
    yield "faces has dtype float64", lambda: scene().add_triangles(POINTS, [[0.0, 1.0, 0.0]])
    yield "faces has shape (1, 4)", lambda: scene().add_triangles(POINTS, [[0, 1, 0, 1]])
    yield (
        "normals has 1 rows: expected 2, one a vertex",
        lambda: scene().add_triangles(POINTS, np.zeros((0, 3), int), normals=[[0, 0, 1]]),
    )
    yield (
        "uv has shape (2, 3): expected (N, 2)",
        lambda: scene().add_triangles(POINTS, np.zeros((0, 3), int), uv=np.zeros((2, 3))),
    )
    yield (
        "color has 3 rows: expected 2, one a face; of vertices: color[faces].mean(axis=1)",
        lambda: scene().add_triangles(np.eye(3), [[0, 1, 2], [0, 2, 1]], color=np.eye(3)),
    )
    yield "matrix has shape (3, 3)", lambda: scene().add_group(np.eye(3))
    yield (
        "matrix[3] is [0.0, 0.0, 0.5, 1.0]",
        lambda: scene().add_group([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0.5, 1]]),
    )
    yield "matrix is singular", lambda: scene().add_group(np.diag([1, 0, 1, 1]))
    yield "matrix[0, 3] is inf", lambda: scene().add_group([[1, 0, 0, np.inf], *np.eye(4)[1:]])
    yield "target is (1.0, 2.0, 3.0)", lambda: scene().look_at((1, 2, 3), (1, 2, 3))
    yield "up is (0.0, 0.0, 2.0)", lambda: dotray.Camera((0, 0, 0), (0, 0, -1), up=(0, 0, 2))
    yield "half_angle is 2", lambda: dotray.Camera((0, 0, 0), (0, 0, -1), half_angle=2)
    yield "direction is (0, 0, 0)", lambda: dotray.DirectionalLight((0, 0, 0))
    yield "attenuation is (0.0, 0.0, 0.0)", lambda: dotray.PointLight((0, 0, 0), attenuation=(0, 0, 0))
    yield "radius is 0", lambda: dotray.AreaLight((0, 0, 0), (0, 1, 0), 0)
    yield "cutoff is 4", lambda: dotray.SpotLight((0, 0, 0), (0, 1, 0), cutoff=4)
    yield "k_specular is -1", lambda: dotray.Material(k_specular=-1)
    yield "index_of_refraction is 0.0", lambda: dotray.Material(k_transmission=1, index_of_refraction=0)
    yield "text is 'a!b'", lambda: dotray.Material(text="a!b")
    yield "texture has shape (4, 4)", lambda: dotray.Texture(np.zeros((4, 4)))
    yield "width is 0: expected 1 to", lambda: scene().render(0, 10)
    yield "width is 1.5: expected a whole number", lambda: scene().render(1.5, 10)
    yield "recursion is 1001", lambda: scene().render(8, 8, recursion=1001)
    yield "aa is \"smooth\"; expected 'none'", lambda: scene().render(8, 8, aa="smooth")
    yield "aa is 65", lambda: scene().render(8, 8, aa=65)
    yield 'shadows is "soft"', lambda: scene().render(8, 8, shadows="soft")
    yield "crop is 4,4,8,8", lambda: scene().render(8, 8, crop=(4, 4, 8, 8))
    yield "crop has 2 numbers", lambda: scene().render(8, 8, crop=(4, 4))
    yield 'layers has "deep"; expected some of depth', lambda: scene().render(8, 8, layers=["deep"])
    yield 'accel is "tree"', lambda: scene().render(8, 8, accel="tree")
    yield "lights[0] is 'sun'", lambda: setattr(scene(), "lights", ["sun"])
    yield "pixels has shape (2, 2)", lambda: dotray.Image(np.zeros((2, 2)))
    yield (
        "the pictures have different sizes: 2 x 2 and 3 x 2",
        lambda: dotray.compare(np.zeros((2, 2, 3)), np.zeros((2, 3, 3))),
    )
    yield "rays has shape (2, 3): expected (..., 6)", lambda: dotray.RayCaster(scene()).cast_rays(np.zeros((2, 3)))
    yield (
        "rays[1] has the direction (0, 0, 0)",
        lambda: dotray.RayCaster(scene()).occluded([[0, 0, 0, 0, 0, 1.0], [0] * 6]),
    )
    yield "rays[0, 4] is nan", lambda: dotray.RayCaster(scene()).count_hits([[0, 0, 0, 0, NAN, 1]])
    yield (
        "t_max is 1.0: expected a number above t_min, 2",
        lambda: dotray.RayCaster(scene()).all_hits([[0, 0, 0, 0, 0, 1]], t_min=2, t_max=1.0),
    )


@pytest.mark.parametrize(("message", "call"), list(faults()), ids=[message for message, _ in faults()])
def test_faults_are_named(message, call):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


def test_a_fault_leaves_the_scene_as_it_was():
    scene = dotray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    with pytest.raises(ValueError):
        scene.add_spheres([0, 0, 0], -1)
    assert scene.shape_count == 1


def test_numbers_that_change_after_they_were_checked_are_told():
    radii = np.ones(3)
    scene = dotray.Scene()
    scene.add_spheres(np.zeros((3, 3)), radii)
    radii[1] = -1
    with pytest.raises(ValueError, match=re.escape("spheres[1]: the radius must be above 0")):
        scene.render(8, 8)


def test_faces_without_area_are_left_out_and_told():
    scene = dotray.Scene()
    with pytest.warns(UserWarning, match=re.escape("1 faces without area are left out, faces[1] first")):
        scene.add_triangles([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2], [0, 0, 1], [2, 1, 0]], color=np.eye(3))
    assert scene.shape_count == 2
    caster = dotray.RayCaster(scene)
    found = caster.all_hits([0, 0, 3, 0, 0, -1])
    assert found["primitive_ids"].tolist() == [0, 2]


def test_scene_errors_carry_the_whole_report(tmp_path):
    path = tmp_path / "bad.ray"
    path.write_text("#shape_spere 0 0 0 0 1\n#camera 1 2\n")
    with pytest.raises(dotray.SceneError) as caught:
        dotray.load(path)
    assert "bad.ray:1:1: error[unknown-directive]" in str(caught.value) and "bad.ray:2:" in str(caught.value)
    with pytest.raises(FileNotFoundError):
        dotray.load(tmp_path / "none.ray")
