//! A scene file as `.ray` text in one canonical form: reading it back gives the same file, apart from places.

mod foreign;
mod hmc;

use crate::dialect::Dialect;
use crate::model::Attenuation;
use crate::model::Camera;
use crate::model::Item;
use crate::model::Light;
use crate::model::Material;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::Tint;
use crate::model::Vertex;
use crate::number::Shortest;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use std::fmt;
use std::fmt::Write;

/// The text of one file in its own dialect. Names and material texts that no `.ray` text can hold (a `!` inside `!…!`,
/// a `"` inside a name that needs quotation marks) lose those signs.
pub fn write(file: &SceneFile) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_to(file, &mut text);
    text
}

/// Writes the text of one file piece by piece, for scenes too big to hold their text.
///
/// # Errors
/// Those of `out`.
pub fn write_to(file: &SceneFile, out: &mut impl Write) -> fmt::Result {
    if file.dialect == Dialect::Hmc {
        return hmc::write_file(out, file);
    }
    if is_empty(file) {
        // A text without any directive would be no scene.
        return writeln!(out, "#light_num 0");
    }
    let by_weights = match file.dialect {
        Dialect::Uva | Dialect::Jhu => true,
        Dialect::Slides | Dialect::Hmc | Dialect::Unisa => false,
    };
    // Only the slides' own and `uva` say how many follow.
    let counted = file.dialect != Dialect::Jhu;
    let in_degrees = file.dialect == Dialect::Unisa;
    if in_degrees && !file.vertex_colors.is_empty() {
        writeln!(out, "#shader \"none\" \"VertexColour\"")?;
    } else if in_degrees && file.vertices.is_empty() {
        // Nothing else would tell the dialect.
        writeln!(out, "#shader \"none\" \"none\"")?;
    }
    if let Some(camera) = file.camera.as_ref().filter(|_| by_weights) {
        foreign::write_camera(out, &camera.value)?;
    } else if let Some(camera) = file.camera.as_ref().filter(|_| in_degrees) {
        hmc::write_camera(out, &camera.value)?;
    } else if let Some(camera) = &file.camera {
        let Camera { position, direction, up, half_angle } = camera.value;
        let angle = Shortest(half_angle);
        writeln!(out, "#camera {} {} {} {angle}", Triple(position), Triple(direction), Triple(up))?;
    }
    if let Some(background) = &file.background {
        writeln!(out, "#background {}", Triple(background.value))?;
    }
    if let Some(ambient) = &file.ambient {
        writeln!(out, "#ambient {}", Triple(ambient.value))?;
    }
    let mut tints = file.tints.iter().chain(std::iter::repeat(&Tint::PLAIN));
    write_list(out, counted, "#light_num", &file.lights, |out, light| match (by_weights, tints.next()) {
        (true, Some(tint)) => foreign::write_light(out, file.dialect, &light.value, tint),
        (true, None) | (false, _) => write_light(out, file.dialect, &light.value),
    })?;
    write_list(out, counted, "#texture_num", &file.textures, |out, name| {
        writeln!(out, "#texture {}", Name(&name.value))
    })?;
    write_list(out, counted, "#material_num", &file.materials, |out, material| match by_weights {
        true => foreign::write_material(out, &material.value),
        false => write_material(out, &material.value),
    })?;
    // Without any colours, white ones tell the dialect and change nothing.
    let white = if file.vertex_colors.is_empty() { Some(Vec3::ONE) } else { None };
    let mut colors = file.vertex_colors.iter().copied().chain(std::iter::repeat(white));
    write_list(out, counted, "#vertex_num", &file.vertices, |out, Vertex { position, normal, texcoord }| {
        write!(out, "#vertex {} {} {}", Triple(*position), Triple(*normal), Pair(*texcoord))?;
        match colors.next().flatten().filter(|_| in_degrees) {
            Some(color) => writeln!(out, " {}", Triple(color)),
            None => writeln!(out),
        }
    })?;
    for include in &file.includes {
        writeln!(out, "#ray_file {}", Name(&include.value.name))?;
    }
    if file.dialect == Dialect::Jhu { foreign::write_items(out, file) } else { write_items(out, file) }
}

fn is_empty(file: &SceneFile) -> bool {
    let SceneFile {
        camera, background, ambient, lights, textures, materials, vertices, includes, items, ..
    } = file;
    let singles = camera.is_none() && background.is_none() && ambient.is_none();
    let numbered = lights.is_empty() && textures.is_empty() && materials.is_empty() && vertices.is_empty();
    singles && numbered && includes.is_empty() && items.is_empty()
}

/// The hint and the entries; nothing for an empty list.
fn write_list<T, W: Write>(
    out: &mut W,
    counted: bool,
    hint: &str,
    list: &[T],
    mut entry: impl FnMut(&mut W, &T) -> fmt::Result,
) -> fmt::Result {
    if list.is_empty() {
        return Ok(());
    }
    if counted {
        writeln!(out, "{hint} {}", list.len())?;
    }
    list.iter().try_for_each(|value| entry(out, value))
}

fn write_light(out: &mut impl Write, dialect: Dialect, light: &Light) -> fmt::Result {
    match light {
        Light::Point { color, position, attenuation } => {
            writeln!(out, "#light_point {} {} {}", Triple(*color), Triple(*position), Fading(attenuation))
        }
        Light::Spot { .. } if matches!(dialect, Dialect::Hmc | Dialect::Unisa) => hmc::write_spot(out, light),
        Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => {
            let [color, position, direction] = [*color, *position, *direction].map(Triple);
            let [cutoff, dropoff] = [*cutoff, *dropoff].map(Shortest);
            let fading = Fading(attenuation);
            writeln!(out, "#light_spot {color} {position} {direction} {fading} {cutoff} {dropoff}")
        }
        Light::Directional { color, direction } => {
            writeln!(out, "#light_dir {} {}", Triple(*color), Triple(*direction))
        }
        Light::Area { color, position, direction, radius, attenuation } => {
            let [color, position, direction] = [*color, *position, *direction].map(Triple);
            let [radius, fading] = [&Shortest(*radius) as &dyn fmt::Display, &Fading(attenuation)];
            writeln!(out, "#light_area {color} {position} {direction} {radius} {fading}")
        }
    }
}

fn write_material(out: &mut impl Write, material: &Material) -> fmt::Result {
    let Material { ambient, diffuse, specular, emissive, texture, text, .. } = material;
    let [ambient, diffuse, specular, emissive] = [*ambient, *diffuse, *specular, *emissive].map(Triple);
    let [ks, kt, ir] =
        [material.k_specular, material.k_transmission, material.index_of_refraction].map(Shortest);
    let texture = texture.map_or(-1, i64::from);
    let text = text.replace('!', "");
    writeln!(out, "#material {ambient} {diffuse} {specular} {emissive} {ks} {kt} {ir} {texture} !{text}!")
}

fn write_items(out: &mut impl Write, file: &SceneFile) -> fmt::Result {
    let mut depth = 0_usize;
    for item in &file.items {
        match item {
            Item::Open(group) => {
                let matrix = file.groups.get(*group as usize).map_or(Mat4::IDENTITY, |placed| placed.value);
                writeln!(out, "{}#group_begin  {}", Indent(depth), Rows(matrix))?;
                depth += 1;
            }
            Item::Close => {
                depth = depth.saturating_sub(1);
                writeln!(out, "{}#group_end", Indent(depth))?;
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

fn write_shape(out: &mut impl Write, file: &SceneFile, kind: ShapeKind, index: usize) -> fmt::Result {
    let material = file.shape_materials(kind).get(index).copied().unwrap_or(-1);
    write!(out, "{} {material}", kind.directive())?;
    match kind {
        ShapeKind::Sphere => file.spheres.shapes.get(index).map_or(Ok(()), |sphere| {
            write!(out, " {} {}", Triple(sphere.center()), Shortest(sphere.radius()))
        }),
        ShapeKind::Cuboid => {
            file.cuboids.shapes.get(index).map_or(Ok(()), |cuboid| {
                write!(out, " {} {}", Triple(cuboid.center()), Triple(cuboid.size()))
            })
        }
        ShapeKind::Cylinder => file.cylinders.shapes.get(index).map_or(Ok(()), |cylinder| {
            let [radius, height] = [cylinder.radius(), cylinder.height()].map(Shortest);
            write!(out, " {} {radius} {height}", Triple(cylinder.center()))
        }),
        ShapeKind::Cone => file.cones.shapes.get(index).map_or(Ok(()), |cone| {
            let [radius, height, top] = [cone.radius(), cone.height(), cone.top()].map(Shortest);
            write!(out, " {} {radius} {height}", Triple(cone.center()))?;
            if cone.top() > 0.0 { write!(out, " {top}") } else { Ok(()) }
        }),
        ShapeKind::Triangle => file.triangles.shapes.get(index).map_or(Ok(()), |triangle| {
            let [a, b, c] = triangle.vertices().map(Triple);
            let [na, nb, nc] = triangle.normals().map(Triple);
            let [ta, tb, tc] = triangle.texcoords().map(Pair);
            write!(out, "  {a}  {b}  {c}  {na}  {nb}  {nc}  {ta}  {tb}  {tc}")
        }),
        ShapeKind::Torus => file.tori.shapes.get(index).map_or(Ok(()), |torus| {
            let [tube, ring] = [torus.tube(), torus.ring()].map(Shortest);
            write!(out, " {} {tube} {ring}", Triple(torus.center()))
        }),
        ShapeKind::Open => file.open_sides.shapes.get(index).map_or(Ok(()), |side| {
            let (center, numbers, top) = match side {
                OpenSide::Cylinder(shape) => (shape.center(), [shape.radius(), shape.height()], None),
                OpenSide::Cone(shape) => {
                    (shape.center(), [shape.radius(), shape.height()], Some(shape.top()))
                }
            };
            let [radius, height] = numbers.map(Shortest);
            write!(out, " {} {radius} {height}", Triple(center))?;
            top.map_or(Ok(()), |top| write!(out, " {}", Shortest(top)))
        }),
        ShapeKind::IndexedTriangle => {
            file.indexed_triangles.shapes.get(index).map_or(Ok(()), |[a, b, c]| write!(out, " {a} {b} {c}"))
        }
    }?;
    writeln!(out)
}

/// Two blanks a level, but never more than 64: deep nesting must not make the text grow with its square.
struct Indent(usize);

impl fmt::Display for Indent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = 2 * self.0.min(32);
        write!(f, "{:width$}", "")
    }
}

struct Triple(Vec3);

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", Shortest(self.0.x), Shortest(self.0.y), Shortest(self.0.z))
    }
}

struct Pair(Vec2);

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", Shortest(self.0.x), Shortest(self.0.y))
    }
}

struct Fading<'a>(&'a Attenuation);

impl fmt::Display for Fading<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Attenuation { constant, linear, quadratic } = *self.0;
        write!(f, "{} {} {}", Shortest(constant), Shortest(linear), Shortest(quadratic))
    }
}

/// A matrix row by row, rows two blanks apart.
struct Rows(Mat4);

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in 0..4 {
            let [a, b, c, d] = self.0.row(row).to_array().map(Shortest);
            let gap = if row == 0 { "" } else { "  " };
            write!(f, "{gap}{a} {b} {c} {d}")?;
        }
        Ok(())
    }
}

/// A file name, quoted where it would not be read as one word.
struct Name<'a>(&'a str);

impl fmt::Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.0;
        // Signs that mean something else do so only where a token may start.
        let starts = ["#", "!", "\"", "//", "/*"].iter().any(|sign| name.starts_with(sign));
        let blanks = [' ', '\t', '\n', '\r', '\u{b}', '\u{c}'];
        if name.is_empty() || starts || name.contains(blanks) {
            write!(f, "\"{}\"", name.replace('"', ""))
        } else {
            f.write_str(name)
        }
    }
}
