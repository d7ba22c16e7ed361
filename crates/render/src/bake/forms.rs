//! The form of each shape, and what rules it out in single precision.

use super::Baked;
use super::Lists;
use super::written_corners;
use super::written_shape;
use crate::form::Form;
use crate::form::Slot;
use crate::form::axis_aligned;
use crate::own::OwnCuboid;
use crate::own::OwnRound;
use crate::own::OwnSphere;
use crate::spine::Spine;
use crate::stretch::Stretch;
use dotray_accel::narrow::Frame;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Shape;
use dotray_geometry::Sphere;
use dotray_geometry::Vec3;
use dotray_geometry::shape::OrientedCone;
use dotray_geometry::shape::OrientedCylinder;
use dotray_geometry::similarity_scale;
use dotray_scene::model::ShapeKind;

/// Where a shape stands.
struct Place<'a> {
    /// Where single precision rules shapes out.
    culls: Option<&'a Frame>,
    world_from_object: &'a Affine,
    /// What lengths are multiplied by, where that is the same for all.
    similarity: Option<f64>,
    /// Whether no other shape stands in the same group.
    alone: bool,
}

/// Puts a shape into the list of its form.
fn put<T>(list: &mut Vec<T>, form: Form, value: T) -> Slot {
    list.push(value);
    Slot::new(form, list.len() - 1)
}

/// The entries of a list at the places of these shapes. They are read in the order of leaves, each from another place,
/// and a short loop waits for many of them at once.
fn gathered<T: Copy>(list: &[T], stretch: &Stretch, numbers: &[u32]) -> Vec<T> {
    numbers.iter().map(|&number| list[stretch.entry(number)]).collect()
}

impl Baked {
    /// Appends the forms of these shapes, which all stand in this stretch.
    pub(super) fn push_forms(&mut self, lists: &Lists, stretch: &Stretch, numbers: &[u32]) {
        let run = &stretch.run;
        let file = &lists.files[run.file.0 as usize];
        if run.kind == ShapeKind::Sphere && run.frame == 0 {
            return self.push_spheres(lists, &file.spheres.shapes, stretch, numbers);
        }
        let matrix = |number: u32| &lists.matrices[stretch.frame(number)];
        let own: Vec<Affine> = match stretch.alone {
            true => numbers.iter().map(|&number| *matrix(number)).collect(),
            false => Vec::new(),
        };
        let shared = matrix(run.first_shape);
        let place = |index: usize| {
            let world_from_object = own.get(index).unwrap_or(shared);
            let similarity = if run.frame == 0 { Some(1.0) } else { similarity_scale(world_from_object) };
            Place { culls: lists.cull_frame.as_ref(), world_from_object, similarity, alone: stretch.alone }
        };
        match run.kind {
            ShapeKind::Sphere => {
                for (index, sphere) in gathered(&file.spheres.shapes, stretch, numbers).iter().enumerate() {
                    let slot = self.bake_sphere(sphere, &place(index));
                    self.slots.push(slot);
                }
            }
            ShapeKind::Cuboid => {
                for (index, cuboid) in gathered(&file.cuboids.shapes, stretch, numbers).iter().enumerate() {
                    let slot = self.bake_cuboid(cuboid, &place(index));
                    self.slots.push(slot);
                }
            }
            ShapeKind::Cylinder => {
                let cylinders = gathered(&file.cylinders.shapes, stretch, numbers);
                for (index, cylinder) in cylinders.iter().enumerate() {
                    let slot = self.bake_cylinder(cylinder, &place(index));
                    self.slots.push(slot);
                }
            }
            ShapeKind::Cone => {
                for (index, cone) in gathered(&file.cones.shapes, stretch, numbers).iter().enumerate() {
                    let slot = self.bake_cone(cone, &place(index));
                    self.slots.push(slot);
                }
            }
            ShapeKind::Triangle | ShapeKind::IndexedTriangle => {
                let corners = |&number| written_corners(run, &lists.files, stretch.entry(number));
                let triangles: Vec<_> = numbers.iter().map(corners).collect();
                for (index, corners) in triangles.iter().enumerate() {
                    let slot = self.bake_triangle(corners, &place(index));
                    self.slots.push(slot);
                }
            }
            ShapeKind::Torus | ShapeKind::Open => {
                for (index, &number) in numbers.iter().enumerate() {
                    let shape = written_shape(run, &lists.files, stretch.entry(number));
                    let slot = self.bake_other(&shape, &place(index));
                    self.slots.push(slot);
                }
            }
        }
    }

    /// Spheres in no group come by the million.
    fn push_spheres(&mut self, lists: &Lists, written: &[Sphere], stretch: &Stretch, numbers: &[u32]) {
        let (first, place) = (self.spheres.len(), self.slots.len());
        let spheres = gathered(written, stretch, numbers);
        self.spheres.extend(&spheres);
        self.slots.extend((first..first + numbers.len()).map(|index| Slot::new(Form::Sphere, index)));
        if let Some(frame) = &lists.cull_frame {
            for (sphere, position) in spheres.iter().zip(place..) {
                self.culls.put_ball(frame, position, sphere.center(), sphere.radius());
            }
        }
    }

    /// A sphere that stays one in the world, or an ellipsoid.
    fn bake_sphere(&mut self, sphere: &Sphere, place: &Place<'_>) -> Slot {
        let matrix = place.world_from_object;
        let in_world = place.similarity.and_then(|scale| {
            Sphere::new(matrix.transform_point3(sphere.center()), sphere.radius() * scale).ok()
        });
        match &in_world {
            Some(sphere) => {
                if let Some(frame) = place.culls {
                    self.culls.put_ball(frame, self.slots.len(), sphere.center(), sphere.radius());
                }
            }
            None => self.cull_box(place, |matrix| sphere.world_bounds(matrix)),
        }
        match in_world {
            in_world if place.alone => {
                let own = OwnSphere::of(sphere, matrix, in_world.is_some(), &mut self.spills);
                put(&mut self.own_spheres, Form::OwnSphere, own)
            }
            Some(sphere) => {
                self.spheres.push(sphere);
                Slot::new(Form::Sphere, self.spheres.len() - 1)
            }
            None => put(&mut self.framed_spheres, Form::FramedSphere, *sphere),
        }
    }

    /// A box that is axis-aligned in the world, or a parallelepiped.
    fn bake_cuboid(&mut self, cuboid: &Cuboid, place: &Place<'_>) -> Slot {
        let matrix = place.world_from_object;
        self.cull_box(place, |matrix| cuboid.world_bounds(matrix));
        match axis_aligned(cuboid, matrix) {
            in_world if place.alone => {
                let own = OwnCuboid::of(cuboid, matrix, in_world.is_some(), &mut self.spills);
                put(&mut self.own_cuboids, Form::OwnCuboid, own)
            }
            Some(cuboid) => put(&mut self.cuboids, Form::Cuboid, cuboid),
            None => put(&mut self.framed_cuboids, Form::FramedCuboid, *cuboid),
        }
    }

    fn bake_cylinder(&mut self, cylinder: &Cylinder, place: &Place<'_>) -> Slot {
        let matrix = place.world_from_object;
        let in_world = place.similarity.map(|scale| OrientedCylinder::from_object(cylinder, matrix, scale));
        match &in_world {
            Some(c) => self.cull_bar(place, &Spine::along(c.base(), c.axis(), c.radius(), c.height())),
            None => self.cull_framed_bar(
                place,
                |matrix| cylinder.world_bounds(matrix),
                cylinder.center(),
                cylinder.radius(),
            ),
        }
        match in_world {
            in_world if place.alone => {
                let own = OwnRound::of_cylinder(cylinder, matrix, in_world.is_some(), &mut self.spills);
                put(&mut self.own_cylinders, Form::OwnCylinder, own)
            }
            Some(cylinder) => put(&mut self.cylinders, Form::Cylinder, cylinder),
            None => put(&mut self.framed_cylinders, Form::FramedCylinder, *cylinder),
        }
    }

    fn bake_cone(&mut self, cone: &Cone, place: &Place<'_>) -> Slot {
        let matrix = place.world_from_object;
        let in_world = place.similarity.map(|scale| OrientedCone::from_object(cone, matrix, scale));
        match &in_world {
            Some(c) => self.cull_bar(place, &Spine::along(c.base(), c.axis(), c.widest(), c.height())),
            None => {
                self.cull_framed_bar(place, |matrix| cone.world_bounds(matrix), cone.center(), cone.widest())
            }
        }
        match in_world {
            in_world if place.alone => {
                let own = OwnRound::of_cone(cone, matrix, in_world.is_some(), &mut self.spills);
                put(&mut self.own_cones, Form::OwnCone, own)
            }
            Some(cone) => put(&mut self.cones, Form::Cone, cone),
            None => put(&mut self.framed_cones, Form::FramedCone, *cone),
        }
    }

    fn bake_triangle(&mut self, corners: &[Vec3; 3], place: &Place<'_>) -> Slot {
        let corners = corners.map(|corner| place.world_from_object.transform_point3(corner));
        if let Some(frame) = place.culls {
            self.culls.put_triangle(frame, self.slots.len(), &corners);
        }
        put(&mut self.triangles, Form::Triangle, corners)
    }

    /// A shape of a rare kind.
    fn bake_other(&mut self, shape: &Shape, place: &Place<'_>) -> Slot {
        self.cull_box(place, |matrix| shape.world_bounds(matrix));
        put(&mut self.framed_others, Form::FramedOther, *shape)
    }

    fn cull_box(&mut self, place: &Place<'_>, bounds: impl Fn(&Affine) -> Aabb) {
        if let Some(frame) = place.culls {
            self.culls.put_box(frame, self.slots.len(), &bounds(place.world_from_object));
        }
    }

    fn cull_bar(&mut self, place: &Place<'_>, spine: &Spine) {
        if let Some(frame) = place.culls {
            self.culls.put_bar(frame, self.slots.len(), spine);
        }
    }

    /// A cylinder or cone that a general map has squeezed.
    fn cull_framed_bar(
        &mut self,
        place: &Place<'_>,
        bounds: impl Fn(&Affine) -> Aabb,
        center: Vec3,
        radius: f64,
    ) {
        let matrix = place.world_from_object;
        match Spine::new(matrix, &bounds(matrix), center, radius) {
            Some(spine) => self.cull_bar(place, &spine),
            None => self.cull_box(place, bounds),
        }
    }
}
