//! Scenes in the `.ray` language.

use crate::scenes;
use crate::scenes::Mesh;
use crate::scenes::Rod;
use crate::scenes::Scene;
use crate::scenes::Shapes;
use crate::scenes::View;
use std::io;
use std::io::Write;

fn numbers(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// Writes the whole file.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let View { eye, angle, .. } = scene.view;
    let camera = [eye, scene.view.direction(), View::UP].concat();
    writeln!(out, "// {}", scene.law)?;
    writeln!(out, "#camera {} {}", numbers(&camera), (angle * 0.5).to_radians())?;
    writeln!(out, "#background {}", numbers(&scenes::BACKGROUND))?;
    writeln!(out, "#ambient {}", numbers(&[scenes::AMBIENT; 3]))?;
    writeln!(out, "#light_num 1\n#light_point 1 1 1 {} 1 0 0", numbers(&scenes::LIGHT))?;
    writeln!(out, "#texture_num 0\n#material_num {}", scene.materials.len())?;
    for material in &scene.materials {
        let diffuse = material.color.map(|c| c * scenes::DIFFUSE);
        // A material that is no mirror has no highlight either: with an exponent of 0 it would be everywhere.
        let specular = if material.reflection > 0.0 { 1.0 } else { 0.0 };
        let colors = [material.color, diffuse, [specular; 3], [0.0; 3]].concat();
        writeln!(out, "#material {} {} 0 1 -1 !!", numbers(&colors), material.reflection)?;
    }
    match &scene.shapes {
        Shapes::Balls(balls) => {
            for ball in balls {
                let ([x, y, z], r) = (ball.center, ball.radius);
                writeln!(out, "#shape_sphere {} {x} {y} {z} {r}", ball.material)?;
            }
            Ok(())
        }
        Shapes::Cylinders(rods) => rods.iter().try_for_each(|rod| write_rod(rod, "cylinder", out)),
        Shapes::Cones(rods) => rods.iter().try_for_each(|rod| write_rod(rod, "cone", out)),
        Shapes::Blocks(blocks) => blocks.iter().try_for_each(|block| {
            begin_group(&block.axes, block.center.map(f64::from), out)?;
            let [x, y, z] = block.size;
            writeln!(out, "#shape_box {} 0 0 0 {x} {y} {z}\n#group_end", block.material)
        }),
        Shapes::Mesh(mesh) => write_mesh(mesh, out),
    }
}

/// A group that turns the axes to `axes` and moves the origin to `center`.
fn begin_group(axes: &[[f64; 3]; 3], center: [f64; 3], out: &mut impl Write) -> io::Result<()> {
    let row = |i: usize| [axes[0][i], axes[1][i], axes[2][i], center[i]];
    writeln!(out, "#group_begin {} 0 0 0 1", numbers(&[row(0), row(1), row(2)].concat()))
}

fn write_rod(rod: &Rod, word: &str, out: &mut impl Write) -> io::Result<()> {
    let [base, top] = [rod.base, rod.top].map(|end| end.map(f64::from));
    let along = [0, 1, 2].map(|i| top[i] - base[i]);
    let height = (along[0] * along[0] + along[1] * along[1] + along[2] * along[2]).sqrt();
    let y = scenes::unit(along);
    let [x, z] = scenes::across(y);
    begin_group(&[x, y, z], [0, 1, 2].map(|i| 0.5 * (base[i] + top[i])), out)?;
    writeln!(out, "#shape_{word} {} 0 0 0 {} {height}\n#group_end", rod.material, rod.radius)
}

fn write_mesh(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    for face in &mesh.faces {
        write!(out, "#shape_triangle 0")?;
        for [x, y, z] in face.map(|corner| mesh.positions[corner as usize]) {
            write!(out, " {x} {y} {z}")?;
        }
        for corner in face {
            // Normals of length 0 are the face's.
            let [x, y, z] = mesh.normals.get(*corner as usize).copied().unwrap_or_default();
            write!(out, " {x} {y} {z}")?;
        }
        writeln!(out, " 0 0 1 0 0 1")?;
    }
    Ok(())
}
