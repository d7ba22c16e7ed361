//! What the dialects `uva` and `jhu` write in other words than the slides.

use super::Fading;
use super::Indent;
use super::Rows;
use super::Triple;
use super::write_shape;
use crate::dialect::Dialect;
use crate::model::Camera;
use crate::model::Item;
use crate::model::Light;
use crate::model::Material;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::Tint;
use crate::model::Weights;
use crate::number::Shortest;
use dotray_geometry::Mat4;
use std::fmt;
use std::fmt::Write;

/// The whole angle in place of the half one.
pub fn write_camera(out: &mut impl Write, camera: &Camera) -> fmt::Result {
    let Camera { position, direction, up, half_angle } = *camera;
    let angle = Shortest(2.0 * half_angle);
    writeln!(out, "#camera {} {} {} {angle}", Triple(position), Triple(direction), Triple(up))
}

/// Weights by themselves. A material without is written as its coefficients would have it.
pub fn write_material(out: &mut impl Write, material: &Material) -> fmt::Result {
    let Material { ambient, diffuse, specular, emissive, texture, text, .. } = material;
    let transmission = material.k_transmission * *specular;
    let of_coefficients =
        Weights { shininess: 128.0 * material.k_specular, reflection: *specular, transmission };
    let Weights { shininess, transmission, .. } = material.weights.unwrap_or(of_coefficients);
    let [emissive, ambient, diffuse, specular] = [*emissive, *ambient, *diffuse, *specular].map(Triple);
    let [shininess, ir] = [shininess, material.index_of_refraction].map(Shortest);
    let texture = texture.map_or(-1, i64::from);
    let text = text.replace('!', "");
    let transmission = Triple(transmission);
    writeln!(
        out,
        "#material {emissive} {ambient} {diffuse} {specular} {shininess} {transmission} {ir} {texture} !{text}!"
    )
}

/// A drop-off rate that is the exponent; in `jhu` three colours.
pub fn write_light(out: &mut impl Write, dialect: Dialect, light: &Light, tint: &Tint) -> fmt::Result {
    let parts = |color: &crate::model::Color| match dialect {
        Dialect::Jhu => {
            let [a, b, c] = [tint.ambient, tint.diffuse, tint.specular].map(|part| Triple(part * *color));
            format!("{a} {b} {c}")
        }
        Dialect::Slides | Dialect::Uva | Dialect::Hmc | Dialect::Unisa => Triple(*color).to_string(),
    };
    match light {
        Light::Point { color, position, attenuation }
        // No such dialect has area lights.
        | Light::Area { color, position, attenuation, .. } => {
            writeln!(out, "#light_point {} {} {}", parts(color), Triple(*position), Fading(attenuation))
        }
        Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => {
            let [position, direction] = [*position, *direction].map(Triple);
            let [cutoff, dropoff] = [*cutoff, 128.0 * *dropoff].map(Shortest);
            let fading = Fading(attenuation);
            writeln!(out, "#light_spot {} {position} {direction} {fading} {cutoff} {dropoff}", parts(color))
        }
        Light::Directional { color, direction } => {
            writeln!(out, "#light_dir {} {}", parts(color), Triple(*direction))
        }
    }
}

/// The tree of `jhu`: a matrix transforms a list, and triangles stand in lists of one material.
pub fn write_items(out: &mut impl Write, file: &SceneFile) -> fmt::Result {
    let mut depth = 0_usize;
    for item in &file.items {
        match item {
            Item::Open(group) => {
                let matrix = file.groups.get(*group as usize).map_or(Mat4::IDENTITY, |placed| placed.value);
                writeln!(out, "{}#static_affine  {}", Indent(depth), Rows(matrix.transpose()))?;
                writeln!(out, "{}#shape_list_begin", Indent(depth))?;
                depth += 1;
            }
            Item::Close => {
                depth = depth.saturating_sub(1);
                writeln!(out, "{}#shape_list_end", Indent(depth))?;
            }
            Item::Run { kind: ShapeKind::IndexedTriangle, first, count } => {
                write_triangles(out, file, *first as usize, *count as usize, depth)?;
            }
            Item::Run { kind, first, count } => {
                let first = *first as usize;
                for index in first..first + *count as usize {
                    write!(out, "{}", Indent(depth))?;
                    write_shape(out, file, *kind, index)?;
                }
            }
            Item::Instance(include) => writeln!(out, "{}#ray_file_instance {include}", Indent(depth))?,
        }
    }
    Ok(())
}

fn write_triangles(
    out: &mut impl Write,
    file: &SceneFile,
    first: usize,
    count: usize,
    depth: usize,
) -> fmt::Result {
    let list = &file.indexed_triangles;
    let entries = list.shapes.iter().zip(&list.materials).skip(first).take(count);
    let mut open = None;
    for ([i, j, k], material) in entries {
        if open != Some(*material) {
            if open.is_some() {
                writeln!(out, "{}#shape_list_end", Indent(depth))?;
            }
            writeln!(out, "{}#shape_triangles {material}", Indent(depth))?;
            writeln!(out, "{}#shape_list_begin", Indent(depth))?;
            open = Some(*material);
        }
        writeln!(out, "{}#shape_triangle {i} {j} {k}", Indent(depth + 1))?;
    }
    if open.is_some() {
        writeln!(out, "{}#shape_list_end", Indent(depth))?;
    }
    Ok(())
}
