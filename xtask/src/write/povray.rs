//! Scenes in POV-Ray's language.

use crate::scenes;
use crate::scenes::Block;
use crate::scenes::Mesh;
use crate::scenes::Scene;
use crate::scenes::Shapes;
use crate::scenes::View;
use crate::write::HEIGHT;
use crate::write::LEVELS;
use crate::write::WIDTH;
use std::io;
use std::io::Write;

fn vector<T: ToString>(numbers: [T; 3]) -> String {
    format!("<{}>", numbers.map(|n| n.to_string()).join(","))
}

/// Writes the whole file.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let View { eye, at, angle } = scene.view;
    let aspect = f64::from(WIDTH) / f64::from(HEIGHT);
    let across = 2.0 * libm::atan(libm::tan((angle * 0.5).to_radians()) * aspect).to_degrees();
    writeln!(out, "#version 3.7;")?;
    writeln!(out, "global_settings {{ assumed_gamma 1.0 max_trace_level {LEVELS} adc_bailout 0 }}")?;
    writeln!(out, "background {{ rgb {} }}", vector(scenes::BACKGROUND))?;
    writeln!(
        out,
        "camera {{ perspective location {} right -x*{aspect} up y sky {} look_at {} angle {across} }}",
        vector(eye),
        vector(View::UP),
        vector(at)
    )?;
    writeln!(out, "light_source {{ {} rgb 1 }}", vector(scenes::LIGHT))?;
    for (i, material) in scene.materials.iter().enumerate() {
        let (mirror, color) = (material.reflection, vector(material.color));
        writeln!(
            out,
            "#declare T{i} = texture {{ pigment {{ rgb {color} }} finish {{ ambient {} diffuse {} phong {mirror} \
             phong_size {} reflection {mirror} }} }}",
            scenes::AMBIENT,
            scenes::DIFFUSE,
            (128.0 * mirror).max(1.0)
        )?;
    }
    write_shapes(scene, out)
}

/// The shapes in one union a material: a texture that stands with every shape would be copied for every shape.
fn write_shapes(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    if let Shapes::Mesh(mesh) = &scene.shapes {
        return write_mesh(mesh, out);
    }
    for material in 0..scene.materials.len() {
        writeln!(out, "union {{")?;
        match &scene.shapes {
            Shapes::Balls(balls) => {
                for ball in balls.iter().filter(|ball| usize::from(ball.material) == material) {
                    writeln!(out, "sphere{{{},{}}}", vector(ball.center), ball.radius)?;
                }
            }
            Shapes::Cylinders(rods) => {
                for rod in rods.iter().filter(|rod| usize::from(rod.material) == material) {
                    writeln!(out, "cylinder{{{},{},{}}}", vector(rod.base), vector(rod.top), rod.radius)?;
                }
            }
            Shapes::Cones(rods) => {
                for rod in rods.iter().filter(|rod| usize::from(rod.material) == material) {
                    writeln!(out, "cone{{{},{},{},0}}", vector(rod.base), rod.radius, vector(rod.top))?;
                }
            }
            Shapes::Blocks(blocks) => {
                for block in blocks.iter().filter(|block| usize::from(block.material) == material) {
                    write_block(block, out)?;
                }
            }
            Shapes::Mesh(_) => {}
        }
        writeln!(out, "texture {{ T{material} }} }}")?;
    }
    Ok(())
}

fn write_block(block: &Block, out: &mut impl Write) -> io::Result<()> {
    let half = block.size.map(|edge| 0.5 * edge);
    let rows = [block.axes[0], block.axes[1], block.axes[2], block.center.map(f64::from)].concat();
    let matrix = rows.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    writeln!(out, "box{{{},{} matrix<{matrix}>}}", vector(half.map(|x| -x)), vector(half))
}

fn write_mesh(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "mesh2 {{ vertex_vectors {{ {},", mesh.positions.len())?;
    mesh.positions.iter().try_for_each(|&position| writeln!(out, "{},", vector(position)))?;
    if !mesh.normals.is_empty() {
        writeln!(out, "}} normal_vectors {{ {},", mesh.normals.len())?;
        mesh.normals.iter().try_for_each(|&normal| writeln!(out, "{},", vector(normal)))?;
    }
    writeln!(out, "}} face_indices {{ {},", mesh.faces.len())?;
    mesh.faces.iter().try_for_each(|&face| writeln!(out, "{},", vector(face)))?;
    writeln!(out, "}} texture {{ T0 }} }}")
}
