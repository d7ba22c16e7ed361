//! Colours of vertices, which only one dialect has.

use super::carry::Lost;
use super::carry::lose;
use crate::dialect::Dialect;
use crate::model::Color;
use crate::model::Material;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::span::Span;
use std::collections::HashMap;

/// Colours of vertices as materials: a triangle of one colour keeps it, another one takes the mean of its corners'.
pub fn spell_out_vertex_colors(file: &mut SceneFile, to: Dialect, lost: &mut Lost) {
    let mut numbers: HashMap<(i32, [u64; 3]), i32> = HashMap::new();
    let mut meant = 0_u64;
    for index in 0..file.indexed_triangles.shapes.len() {
        let Some([a, b, c]) = file.corner_colors(index) else { continue };
        let Some(&written) = file.indexed_triangles.materials.get(index) else { continue };
        let color = if a == b && a == c {
            a
        } else {
            meant += 1;
            (a + b + c) / 3.0
        };
        let key = (written, color.to_array().map(f64::to_bits));
        let number = *numbers.entry(key).or_insert_with(|| {
            file.materials.push(colored(file.materials.get(written as usize), color));
            file.materials.len() as i32 - 1
        });
        if let Some(material) = file.indexed_triangles.materials.get_mut(index) {
            *material = number;
        }
    }
    file.vertex_colors = Vec::new();
    if meant > 0 {
        let triangles = if meant == 1 { "1 triangle takes" } else { &format!("{meant} triangles take") };
        let message = format!("`{to}` has no colours of vertices: {triangles} the mean of the corners'");
        lose(lost, None, message);
    }
}

/// A material, or the default one, with another ambient and diffuse colour.
fn colored(material: Option<&Placed<Material>>, color: Color) -> Placed<Material> {
    let mut colored =
        material.cloned().unwrap_or_else(|| Placed { value: Material::default(), span: Span::default() });
    (colored.value.ambient, colored.value.diffuse) = (color, color);
    colored
}
