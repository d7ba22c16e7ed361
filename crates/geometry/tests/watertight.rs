//! No ray leaks between triangles that share their corners.

mod common;

use std::collections::BTreeMap;

use common::{affine, point};
use dotray_geometry::{Affine, Ray, TriangleRay, Vec3, intersect_vertices};
use proptest::prelude::*;

struct Mesh {
    vertices: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
}

impl Mesh {
    fn icosahedron() -> Self {
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        let mut vertices = Vec::new();
        for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
            vertices.extend([Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)]);
        }
        // Faces are the triples of corners at the distance of an edge, which is 2.
        let near = |i: usize, j: usize| (vertices[i].distance(vertices[j]) - 2.0).abs() < 1e-9;
        let mut faces = Vec::new();
        for i in 0..12 {
            for j in i + 1..12 {
                for k in j + 1..12 {
                    if near(i, j) && near(j, k) && near(k, i) {
                        let outward =
                            (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]).dot(vertices[i])
                                > 0.0;
                        faces.push(if outward { [i, j, k] } else { [i, k, j] });
                    }
                }
            }
        }
        Self { vertices, faces }
    }

    /// Each triangle in four, the new corners on the unit sphere.
    fn subdivided(mut self) -> Self {
        let mut middles = BTreeMap::new();
        let mut faces = Vec::new();
        for [a, b, c] in self.faces {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    self.vertices
                        .push((self.vertices[i].normalize() + self.vertices[j].normalize()).normalize());
                    self.vertices.len() - 1
                })
            });
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        let vertices = self.vertices.into_iter().map(Vec3::normalize).collect();
        Self { vertices, faces }
    }

    fn mapped(&self, map: &Affine) -> Self {
        let vertices = self.vertices.iter().map(|&v| map.transform_point3(v)).collect();
        Self { vertices, faces: self.faces.clone() }
    }

    fn corners(&self, face: usize) -> [Vec3; 3] {
        self.faces[face].map(|i| self.vertices[i])
    }

    /// Whether the ray meets a face in front of its origin. Also compares the two ways of asking.
    fn stops(&self, ray: &Ray) -> bool {
        let prepared = TriangleRay::new(ray);
        (0..self.faces.len()).any(|face| {
            let corners = self.corners(face);
            let t = prepared.intersect(&corners);
            assert_eq!(t.map(f64::to_bits), intersect_vertices(ray, corners).map(f64::to_bits));
            t.is_some_and(|t| t > 0.0)
        })
    }
}

fn sphere() -> Mesh {
    let mesh = Mesh::icosahedron().subdivided().subdivided();
    assert_eq!((mesh.vertices.len(), mesh.faces.len()), (162, 320));
    mesh
}

#[test]
fn no_ray_from_inside_leaves_through_a_corner_or_an_edge() {
    let mesh = sphere();
    let origins =
        [Vec3::ZERO, Vec3::new(0.1, 0.2, 0.3), Vec3::new(-0.7, 1e-9, 0.1), Vec3::new(0.3, 0.3, 0.3)];
    for origin in origins {
        for face in 0..mesh.faces.len() {
            let [a, b, c] = mesh.corners(face);
            for target in [a, (a + b) * 0.5, a * 0.75 + b * 0.25, (a * 0.9 + c * 0.1)] {
                assert!(mesh.stops(&Ray::new(origin, target - origin)), "{origin} to {target}");
                assert!(mesh.stops(&Ray::new(origin, (target - origin).normalize())), "{origin} to {target}");
            }
        }
    }
}

proptest! {
    #![proptest_config(common::config(4000))]

    #[test]
    fn no_ray_leaves_a_warped_mesh(map in affine(), face in 0..320usize, along in 0.0..=1.0f64, start in point(0.4),
                                   power in -60..60i32) {
        let mesh = sphere().mapped(&map);
        let origin = map.transform_point3(start);
        let [a, b, _] = mesh.corners(face);
        for target in [a, a + (b - a) * along] {
            let ray = Ray::new(origin, (target - origin) * libm::scalbn(1.0, power));
            prop_assert!(mesh.stops(&ray));
        }
    }

    #[test]
    fn a_shared_edge_lets_nothing_through(corners in prop::array::uniform4(point(1.0)), along in 0.0..=1.0f64,
                                          origin in point(1.0), distance in 1.0..1e6f64) {
        // Two triangles along the edge from a to b, c on one side of it as the origin sees it and d on the other,
        // as deep in space as they like.
        let [a, b, c, d] = corners;
        let origin = origin * distance;
        let across = (b - a).cross(a - origin);
        prop_assume!(across.length() > 1e-2 * (a - origin).length() * (b - a).length() && (b - a).length() > 1e-2);
        let (left, right) = (across.dot(c - a), across.dot(d - a));
        prop_assume!(left.abs().min(right.abs()) > 1e-3 * across.length());
        let d = if left * right > 0.0 { d - across * (2.0 * right / across.length_squared()) } else { d };
        let ray = Ray::new(origin, a + (b - a) * along - origin);
        let hits = [intersect_vertices(&ray, [a, b, c]), intersect_vertices(&ray, [b, a, d])];
        // Rounding may take a ray past the ends of the edge, which in a mesh belong to more triangles.
        prop_assume!((1e-9..1.0 - 1e-9).contains(&along));
        prop_assert!(hits.iter().any(Option::is_some));
        for t in hits.into_iter().flatten() {
            prop_assert!((t - 1.0).abs() < 1e-6);
        }
    }
}
