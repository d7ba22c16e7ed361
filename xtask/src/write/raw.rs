//! Scenes as raw float32: x y z r of spheres, both ends and their radii of cylinders and cones, nine numbers a
//! triangle.

use crate::scenes::LIGHT;
use crate::scenes::Scene;
use crate::scenes::Shapes;
use crate::scenes::View;
use std::io;
use std::io::Write;
use std::path::Path;

fn put(numbers: &[f32], out: &mut impl Write) -> io::Result<()> {
    numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))
}

/// Writes the shapes.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    match &scene.shapes {
        Shapes::Balls(balls) => balls.iter().try_for_each(|ball| {
            put(&ball.center, out)?;
            put(&[ball.radius], out)
        }),
        Shapes::Cylinders(rods) => rods.iter().try_for_each(|rod| {
            put(&rod.base, out)?;
            put(&[rod.radius], out)?;
            put(&rod.top, out)?;
            put(&[rod.radius], out)
        }),
        Shapes::Cones(rods) => rods.iter().try_for_each(|rod| {
            put(&rod.base, out)?;
            put(&[rod.radius], out)?;
            put(&rod.top, out)?;
            put(&[0.0], out)
        }),
        Shapes::Blocks(_) => Err(io::Error::other("boxes have no raw form")),
        Shapes::Mesh(mesh) => {
            mesh.faces.iter().flatten().try_for_each(|corner| put(&mesh.positions[*corner as usize], out))
        }
    }
}

/// Writes eye, target, up, angle and light, one a line.
pub fn write_camera(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let View { eye, at, angle } = scene.view;
    let line = |v: [f64; 3]| v.map(|x| x.to_string()).join(" ");
    writeln!(out, "{}\n{}\n{}\n{angle}\n{}", line(eye), line(at), line(View::UP), line(LIGHT))
}

/// The thirteen numbers of such a file.
///
/// # Errors
/// Where it is not one.
pub fn camera(path: &Path) -> Result<[f64; 13], String> {
    let text = std::fs::read_to_string(path).map_err(|fault| format!("{}: {fault}", path.display()))?;
    let numbers: Vec<f64> = text.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
    numbers.try_into().map_err(|_| format!("{}: not thirteen numbers", path.display()))
}
