//! Wrong matrices of groups.

use dotray_geometry::Mat4;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_scene::Resolved;
use dotray_scene::Scene;
use dotray_scene::model::Item;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::resolved::Run;
use std::f64::consts::PI;

fn each(scene: &mut Scene, change: impl Fn(Mat4) -> Mat4) {
    let groups = scene.files.iter_mut().flat_map(|file| &mut file.groups);
    groups.for_each(|group| group.value = change(group.value));
}

/// What was the translation then stands in the last row, which programs do not look at.
pub fn transposed(scene: &mut Scene) {
    each(scene, |matrix| {
        let mut transposed = matrix.transpose();
        for column in [&mut transposed.x_axis, &mut transposed.y_axis, &mut transposed.z_axis] {
            column.w = 0.0;
        }
        transposed
    });
}

pub fn rotations_reversed(scene: &mut Scene) {
    each(scene, |matrix| {
        let mut reversed = Mat4::from_mat3(dotray_geometry::Mat3::from_mat4(matrix).transpose());
        reversed.w_axis = matrix.w_axis;
        reversed
    });
}

pub fn ignored(scene: &mut Scene) {
    each(scene, |_| Mat4::IDENTITY);
}

/// The matrices A, B, C from the outside in are to have the product `of([A, B, C])`; each is changed such that the
/// honest product with those around it is that.
fn products(file: &mut SceneFile, of: impl Fn(&[Mat4]) -> Mat4) {
    let mut honest: Vec<Mat4> = Vec::new();
    let mut wanted: Vec<Mat4> = Vec::new();
    for item in &file.items {
        match *item {
            Item::Open(group) => {
                let Some(group) = file.groups.get_mut(group as usize) else { return };
                honest.push(group.value);
                let product = of(&honest);
                let around = wanted.last().copied().unwrap_or(Mat4::IDENTITY);
                group.value = around.inverse() * product;
                wanted.push(product);
            }
            Item::Close => {
                honest.pop();
                wanted.pop();
            }
            Item::Run { .. } | Item::Instance(_) => {}
        }
    }
}

pub fn order_reversed(scene: &mut Scene) {
    for file in &mut scene.files {
        products(file, |chain| chain.iter().rev().fold(Mat4::IDENTITY, |product, matrix| product * *matrix));
    }
}

pub fn inner_only(scene: &mut Scene) {
    for file in &mut scene.files {
        products(file, |chain| chain.last().copied().unwrap_or(Mat4::IDENTITY));
    }
}

const TURNS: u32 = 96;
const RINGS: u32 = 48;

/// Spheres become meshes with normals of their own: MᵀM n, which the inverse transpose takes to M n.
pub fn normals_by_matrix(resolved: &mut Resolved, _: (u32, u32)) {
    let mut first_shape = 0;
    for run in &mut resolved.runs {
        let frame = resolved.frames.get(run.frame as usize);
        let file = resolved.files.get_mut(run.file.0 as usize);
        if let (ShapeKind::Sphere, Some(frame), Some(file)) = (run.kind, frame, file) {
            let matrix = frame.matrix3;
            mesh_of_spheres(run, file, |normal| matrix.transpose() * (matrix * normal));
        }
        run.first_shape = first_shape;
        first_shape += run.count;
    }
    resolved.shape_count = first_shape;
}

fn mesh_of_spheres(run: &mut Run, file: &mut SceneFile, change: impl Fn(Vec3) -> Vec3) {
    // Large scenes are no lessons on normals.
    if run.count > 100 {
        return;
    }
    let first = file.triangles.shapes.len();
    for place in run.first..run.first + run.count {
        let place = place as usize;
        let (Some(sphere), Some(&material)) =
            (file.spheres.shapes.get(place), file.spheres.materials.get(place))
        else {
            continue;
        };
        let (center, radius) = (sphere.center(), sphere.radius());
        let start = file.spheres.starts.get(place).unwrap_or_default();
        for corners in patches() {
            let vertices = corners.map(|normal| center + radius * normal);
            if let Ok(triangle) = Triangle::new(vertices, corners.map(&change), [Vec2::ZERO; 3]) {
                file.triangles.shapes.push(triangle);
                file.triangles.materials.push(material);
                file.triangles.starts.push(start);
            }
        }
    }
    run.kind = ShapeKind::Triangle;
    run.first = first as u32;
    run.count = (file.triangles.shapes.len() - first) as u32;
}

/// The unit sphere in triangles, counter-clockwise seen from outside.
fn patches() -> Vec<[Vec3; 3]> {
    let point = |turn: u32, ring: u32| {
        let across = 2.0 * PI * f64::from(turn % TURNS) / f64::from(TURNS);
        let down = PI * f64::from(ring) / f64::from(RINGS);
        let (sine, cosine) = libm::sincos(down);
        Vec3::new(sine * libm::sin(across), cosine, sine * libm::cos(across))
    };
    let mut patches = Vec::new();
    for (turn, ring) in (0..TURNS).flat_map(|turn| (0..RINGS).map(move |ring| (turn, ring))) {
        let [a, b, c, d] =
            [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(right, below)| point(turn + right, ring + below));
        patches.push([a, b, c]);
        patches.push([a, c, d]);
    }
    patches
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;

    const NESTED: &str = "#group_begin 0 -1 0 5  1 0 0 0  0 0 1 0  0 0 0 1\n\
        #group_begin 2 0 0 0  0 3 0 0  0 0 4 7  0 0 0 1\n\
        #shape_sphere -1 0 0 0 1\n#group_end\n#group_end";

    fn scene() -> Scene {
        load_text("t", NESTED, &Disk, &LoadOptions::default()).scene.unwrap()
    }

    fn honest_product(scene: &Scene) -> Mat4 {
        scene.files[0].groups.iter().fold(Mat4::IDENTITY, |product, group| product * group.value)
    }

    #[test]
    fn wrong_products_come_from_honest_multiplication() {
        let original = scene();
        let [a, b] = [0, 1].map(|place: usize| original.files[0].groups[place].value);
        let mut changed = scene();
        order_reversed(&mut changed);
        assert!(honest_product(&changed).abs_diff_eq(b * a, 1e-12));
        let mut changed = scene();
        inner_only(&mut changed);
        assert!(honest_product(&changed).abs_diff_eq(b, 1e-12));
        let mut changed = scene();
        transposed(&mut changed);
        let first = changed.files[0].groups[0].value;
        assert_eq!(first.transform_point3(Vec3::X), Vec3::new(0.0, -1.0, 0.0));
        let mut changed = scene();
        rotations_reversed(&mut changed);
        assert_eq!(changed.files[0].groups[0].value.transform_point3(Vec3::X), Vec3::new(5.0, -1.0, 0.0));
    }

    #[test]
    fn the_mesh_is_a_sphere_seen_from_outside() {
        for [a, b, c] in patches() {
            let cross = (b - a).cross(c - a);
            assert!(cross.dot(a + b + c) >= -1e-15, "{a} {b} {c}");
            assert!((a.length() - 1.0).abs() < 1e-12);
        }
    }
}
