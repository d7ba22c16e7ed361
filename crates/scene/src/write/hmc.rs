//! The dialect `hmc`: flags, names, and shapes along z.

use super::Fading;
use super::Indent;
use super::Name;
use super::Pair;
use super::Rows;
use super::Triple;
use crate::model::Camera;
use crate::model::Item;
use crate::model::Light;
use crate::model::Material;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::number::Shortest;
use dotray_geometry::Mat3;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use std::f64::consts::PI;
use std::fmt;
use std::fmt::Write;

/// Takes y to z, z to -y: what stands along y elsewhere stands along z here.
const Z_FROM_Y: Mat3 = Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y);

/// Degrees that are read as these radians, in as few digits as such a number has.
pub fn degrees(radians: f64) -> Shortest {
    const DEGREE: f64 = PI / 180.0;
    let near = radians / DEGREE;
    // Rounding leaves a few neighbours that are read alike; of none that is read exactly, the nearest.
    let exact = if (-4..=4).any(|steps| neighbour(near, steps) * DEGREE == radians) {
        radians
    } else {
        near * DEGREE
    };
    let alike = (-4..=4).map(|steps| neighbour(near, steps)).filter(|degrees| degrees * DEGREE == exact);
    Shortest(alike.min_by_key(|degrees| degrees.to_string().len()).unwrap_or(near))
}

/// The double so many steps above a positive one.
fn neighbour(x: f64, steps: i64) -> f64 {
    f64::from_bits(x.to_bits().saturating_add_signed(steps))
}

/// The angle in degrees.
pub fn write_camera(out: &mut impl Write, camera: &Camera) -> fmt::Result {
    let Camera { position, direction, up, half_angle } = *camera;
    let angle = degrees(half_angle);
    writeln!(out, "#camera {} {} {} {angle}", Triple(position), Triple(direction), Triple(up))
}

/// A spot with its cut-off angle in degrees; of all other lights nothing.
pub fn write_spot(out: &mut impl Write, light: &Light) -> fmt::Result {
    let Light::Spot { color, position, direction, attenuation, cutoff, dropoff } = light else {
        return Ok(());
    };
    let [color, position, direction] = [*color, *position, *direction].map(Triple);
    let [cutoff, dropoff] = [degrees(*cutoff), Shortest(*dropoff)];
    let fading = Fading(attenuation);
    writeln!(out, "#light_spot {color} {position} {direction} {fading} {cutoff} {dropoff}")
}

/// The whole file.
pub fn write_file(out: &mut impl Write, file: &SceneFile) -> fmt::Result {
    writeln!(out, "#version HMCCS155FALL2002")?;
    if let Some(camera) = &file.camera {
        write_camera(out, &camera.value)?;
    }
    if let Some(background) = &file.background {
        writeln!(out, "#background {}", Triple(background.value))?;
    }
    if let Some(ambient) = &file.ambient {
        writeln!(out, "#ambient {}", Triple(ambient.value))?;
    }
    for light in &file.lights {
        super::write_light(out, file.dialect, &light.value)?;
    }
    for (number, material) in file.materials.iter().enumerate() {
        write_material(out, file, number, &material.value)?;
    }
    write_items(out, file)?;
    writeln!(out, "#rayfile_end")
}

fn texture_of<'a>(file: &'a SceneFile, material: &Material) -> Option<&'a str> {
    let texture = file.textures.get(material.texture? as usize)?;
    Some(&texture.value)
}

/// The bump image and its scale.
fn bump_of<'a>(file: &'a SceneFile, material: &Material) -> Option<(&'a str, f64)> {
    let bump = material.bump.filter(|bump| bump.scale != 0.0)?;
    Some((&file.textures.get(bump.texture as usize)?.value, bump.scale))
}

/// A flag and the name of a file.
fn write_file_flag(out: &mut impl Write, flag: &str, name: &str) -> fmt::Result {
    // What begins with a `-` would be a flag.
    if name.starts_with('-') {
        write!(out, " {flag} \"{}\"", name.replace('"', ""))
    } else {
        write!(out, " {flag} {}", Name(name))
    }
}

fn write_material(out: &mut impl Write, file: &SceneFile, number: usize, material: &Material) -> fmt::Result {
    let Material { ambient, diffuse, specular, emissive, .. } = material;
    let [ambient, diffuse, specular, emissive] = [*ambient, *diffuse, *specular, *emissive].map(Triple);
    let [ks, kt, ir] =
        [material.k_specular, material.k_transmission, material.index_of_refraction].map(Shortest);
    write!(out, "#material -n m{number}")?;
    if let Some(name) = texture_of(file, material) {
        write_file_flag(out, "-t", name)?;
    }
    if let Some((name, _)) = bump_of(file, material) {
        write_file_flag(out, "-u", name)?;
    }
    writeln!(out, " --  {ambient} {diffuse} {specular} {emissive} {ks} {kt} {ir}")
}

/// Whether a shape stands along an axis.
fn is_round(kind: ShapeKind) -> bool {
    match kind {
        ShapeKind::Cylinder | ShapeKind::Cone | ShapeKind::Torus | ShapeKind::Open => true,
        ShapeKind::Sphere | ShapeKind::Cuboid | ShapeKind::Triangle | ShapeKind::IndexedTriangle => false,
    }
}

fn write_items(out: &mut impl Write, file: &SceneFile) -> fmt::Result {
    let matrix = |group: u32| file.groups.get(group as usize).map_or(Mat4::IDENTITY, |placed| placed.value);
    let mut depth = 0_usize;
    let mut items = file.items.as_slice();
    while let [item, rest @ ..] = items {
        items = rest;
        match (item, rest) {
            // The group that a round shape was read into.
            (Item::Open(group), [Item::Run { kind, first, count }, Item::Close, after @ ..])
                if is_round(*kind) && matrix(*group) == Mat4::from_mat3(Z_FROM_Y) =>
            {
                write_run(out, file, depth, (*kind, *first, *count))?;
                items = after;
            }
            (Item::Open(group), _) => {
                writeln!(out, "{}#group_begin  {}", Indent(depth), Rows(matrix(*group)))?;
                depth += 1;
            }
            (Item::Close, _) => {
                depth = depth.saturating_sub(1);
                writeln!(out, "{}#group_end", Indent(depth))?;
            }
            (Item::Run { kind, first, count }, _) if is_round(*kind) => {
                let back = Mat4::from_mat3(Z_FROM_Y.transpose());
                writeln!(out, "{}#group_begin  {}", Indent(depth), Rows(back))?;
                write_run(out, file, depth + 1, (*kind, *first, *count))?;
                writeln!(out, "{}#group_end", Indent(depth))?;
            }
            (Item::Run { kind, first, count }, _) => {
                write_run(out, file, depth, (*kind, *first, *count))?;
            }
            // A file of this dialect includes no other.
            (Item::Instance(_), _) => {}
        }
    }
    Ok(())
}

fn write_run(
    out: &mut impl Write,
    file: &SceneFile,
    depth: usize,
    (kind, first, count): (ShapeKind, u32, u32),
) -> fmt::Result {
    for index in first as usize..first as usize + count as usize {
        write!(out, "{}", Indent(depth))?;
        write_shape(out, file, kind, index)?;
    }
    Ok(())
}

/// `-m name -t --` and the like.
fn write_flags(
    out: &mut impl Write,
    file: &SceneFile,
    kind: ShapeKind,
    index: usize,
    closed: bool,
) -> fmt::Result {
    let number = file.shape_materials(kind).get(index).and_then(|number| usize::try_from(*number).ok());
    if let Some(number) = number {
        write!(out, " -m m{number}")?;
        let material = file.materials.get(number);
        if material.is_some_and(|material| texture_of(file, &material.value).is_some()) {
            write!(out, " -t")?;
        }
        if let Some((_, scale)) = material.and_then(|material| bump_of(file, &material.value)) {
            write!(out, " -u {}", Shortest(scale))?;
        }
    }
    if closed {
        write!(out, " -c")?;
    }
    if closed || number.is_some() { write!(out, " -- ") } else { Ok(()) }
}

fn write_shape(out: &mut impl Write, file: &SceneFile, kind: ShapeKind, index: usize) -> fmt::Result {
    let mut begin = |word: &str, closed: bool| {
        write!(out, "{word}")?;
        write_flags(out, file, kind, index, closed)
    };
    let round = |center: Vec3, radius: f64, height: f64| {
        let center = Z_FROM_Y * center;
        let [radius, half] = [Shortest(radius), Shortest(height)];
        format!(" {} {radius} {half}", Triple(center - Vec3::Z * (0.5 * height)))
    };
    let numbers = match kind {
        ShapeKind::Sphere => file.spheres.shapes.get(index).map(|sphere| {
            ("#sphere", false, format!(" {} {}", Triple(sphere.center()), Shortest(sphere.radius())))
        }),
        ShapeKind::Cuboid => {
            file.cuboids.shapes.get(index).map(|cuboid| {
                ("#box", false, format!(" {} {}", Triple(cuboid.center()), Triple(cuboid.size())))
            })
        }
        ShapeKind::Cylinder => file
            .cylinders
            .shapes
            .get(index)
            .map(|shape| ("#cylinder", true, round(shape.center(), shape.radius(), shape.height()))),
        ShapeKind::Cone => file
            .cones
            .shapes
            .get(index)
            .map(|shape| ("#cone", true, round(shape.center(), shape.radius(), shape.height()))),
        ShapeKind::Open => file.open_sides.shapes.get(index).map(|side| match side {
            OpenSide::Cylinder(shape) => {
                ("#cylinder", false, round(shape.center(), shape.radius(), shape.height()))
            }
            OpenSide::Cone(shape) => ("#cone", false, round(shape.center(), shape.radius(), shape.height())),
        }),
        ShapeKind::Torus => file.tori.shapes.get(index).map(|torus| {
            let [ring, tube] = [torus.ring(), torus.tube()].map(Shortest);
            ("#torus", false, format!(" {} {ring} {tube}", Triple(Z_FROM_Y * torus.center())))
        }),
        ShapeKind::Triangle => file.triangles.shapes.get(index).map(|triangle| {
            let [a, b, c] = triangle.vertices().map(Triple);
            let mut numbers = format!(" {a}  {b}  {c}");
            if triangle.texcoords() != &[Vec2::ZERO; 3] {
                let [a, b, c] = triangle.texcoords().map(Pair);
                numbers.push_str(&format!("  {a}  {b}  {c}"));
            }
            ("#triangle", false, numbers)
        }),
        // Corners are not shared here.
        ShapeKind::IndexedTriangle => None,
    };
    let Some((word, closed, numbers)) = numbers else { return Ok(()) };
    begin(word, closed)?;
    writeln!(out, "{numbers}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_read_as_they_were_written() {
        for written in [30.0, 45.0, 22.5, 0.1, 89.9, 1e-3, 179.0, 33.3] {
            assert_eq!(degrees(written * (PI / 180.0)).0, written);
        }
        for step in 1..2000 {
            let radians = f64::from(step) * 7.31e-4;
            let once = degrees(radians).0 * (PI / 180.0);
            assert!((once - radians).abs() <= 2e-16 * radians);
            assert_eq!(degrees(once).0 * (PI / 180.0), once);
            assert_eq!(degrees(once).0, degrees(radians).0);
        }
    }
}
