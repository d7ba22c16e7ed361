//! What the dialect `hmc` has no words for.

use super::carry::Lost;
use super::carry::Use;
use super::carry::lose;
use super::carry::push;
use super::carry::replace_runs;
use super::carry::same;
use super::carry::transmission_coefficient;
use crate::model::Item;
use crate::model::Material;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::Vertex;
use crate::model::Weights;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_geometry::shape::face_normal;

/// A material whose mirror has the highlight's weight and whose exponent is 128 ks, with ks at most 1.
pub fn material(material: &mut Material, weights: Weights, at: Use, lost: &mut Lost) {
    if !same(weights.reflection, material.specular) {
        lose(
            lost,
            Some(at.span),
            "the mirror's weight becomes that of the highlight, which is all that `hmc` has",
        );
    }
    let ks = weights.shininess / 128.0;
    let shine = ks.clamp(0.0, 1.0);
    if ks != shine {
        lose(
            lost,
            Some(at.span),
            format!("the highlight's exponent {} becomes {}", 128.0 * ks, 128.0 * shine),
        );
    }
    if !material.text.trim().is_empty() {
        let message = format!("a material of `hmc` has no text: `!{}!` is left out", material.text.trim());
        lose(lost, Some(at.span), message);
        material.text.clear();
    }
    let kt = transmission_coefficient(material.specular, weights.transmission, at, lost);
    (material.k_specular, material.k_transmission) = (shine, kt);
    material.weights = Some(Weights {
        shininess: 128.0 * shine,
        reflection: material.specular,
        transmission: kt * material.specular,
    });
}

/// What stands for a vertex that is not there; the reader lets no such number pass.
const ORIGIN: Vertex = Vertex { position: Vec3::ZERO, normal: Vec3::ZERO, texcoord: Vec2::ZERO };

/// Triangles with corners and normals of their own, or of shared vertices, become flat ones.
pub fn flatten_triangles(file: &mut SceneFile, lost: &mut Lost) {
    let shared = std::mem::take(&mut file.indexed_triangles);
    let vertices = std::mem::take(&mut file.vertices);
    let corner = |number: u32| vertices.get(number as usize).copied().unwrap_or(ORIGIN);
    replace_runs(file, ShapeKind::IndexedTriangle, |file, index| {
        let corners = shared.shapes.get(index).copied().unwrap_or_default().map(corner);
        let shape = Triangle::new(
            corners.map(|corner| corner.position),
            corners.map(|corner| corner.normal),
            corners.map(|corner| corner.texcoord),
        );
        let material = shared.materials.get(index).copied().unwrap_or(-1);
        // The reader let no triangle without area pass.
        let Ok(shape) = shape else { return Item::Run { kind: ShapeKind::Triangle, first: 0, count: 0 } };
        let first = push(&mut file.triangles, shape, material);
        Item::Run { kind: ShapeKind::Triangle, first, count: 1 }
    });
    let mut bent = 0_u64;
    for triangle in &mut file.triangles.shapes {
        let face = face_normal(triangle.vertices());
        let is_flat =
            |normal: &Vec3| *normal == Vec3::ZERO || normal.normalize_or_zero().dot(face).abs() > 1.0 - 1e-12;
        bent += u64::from(!triangle.normals().iter().all(is_flat));
        if let Ok(flat) = Triangle::new(*triangle.vertices(), [Vec3::ZERO; 3], *triangle.texcoords()) {
            *triangle = flat;
        }
    }
    if bent > 0 {
        lose(
            lost,
            None,
            format!("`hmc` has flat triangles only: {bent} of them lose the normals of their corners"),
        );
    }
}
