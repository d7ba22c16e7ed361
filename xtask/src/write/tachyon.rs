//! Scenes in Tachyon's language. Cylinders get discs at their ends, boxes are twelve triangles; there are no cones.

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

fn words<T: ToString>(numbers: [T; 3]) -> String {
    numbers.map(|n| n.to_string()).join(" ")
}

/// Writes the whole file.
pub fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let View { eye, angle, .. } = scene.view;
    let zoom = 0.5 / libm::tan((angle * 0.5).to_radians());
    let direction = scene.view.direction();
    let right = scenes::unit(scenes::cross(direction, View::UP));
    let up = scenes::cross(right, direction);
    writeln!(out, "BEGIN_SCENE\nRESOLUTION {WIDTH} {HEIGHT}\nCAMERA\n ZOOM {zoom}\n ASPECTRATIO 1.0")?;
    writeln!(out, " ANTIALIASING 0\n RAYDEPTH {LEVELS}\n CENTER {}", words(eye))?;
    writeln!(out, " VIEWDIR {}\n UPDIR {}\nEND_CAMERA", words(direction), words(up))?;
    writeln!(out, "BACKGROUND {}", words(scenes::BACKGROUND))?;
    writeln!(out, "LIGHT CENTER {} RAD 0.001 COLOR 1 1 1", words(scenes::LIGHT))?;
    for (i, material) in scene.materials.iter().enumerate() {
        let (mirror, color) = (material.reflection, words(material.color));
        writeln!(
            out,
            "TEXDEF T{i} AMBIENT {} DIFFUSE {} SPECULAR {mirror} OPACITY 1 PHONG PLASTIC {mirror} PHONG_SIZE {} \
             COLOR {color} TEXFUNC 0",
            scenes::AMBIENT,
            scenes::DIFFUSE,
            (128.0 * mirror).max(1.0)
        )?;
    }
    match &scene.shapes {
        Shapes::Balls(balls) => {
            for ball in balls {
                writeln!(out, "SPHERE CENTER {} RAD {} T{}", words(ball.center), ball.radius, ball.material)?;
            }
        }
        Shapes::Cylinders(rods) => {
            for rod in rods {
                let (radius, material) = (rod.radius, rod.material);
                let (base, top) = (words(rod.base), words(rod.top));
                let axis = scenes::unit([0, 1, 2].map(|i| f64::from(rod.top[i] - rod.base[i])));
                writeln!(out, "FCYLINDER BASE {base} APEX {top} RAD {radius} T{material}")?;
                for (center, normal) in [(base, axis.map(|x| -x)), (top, axis)] {
                    let normal = words(normal);
                    writeln!(
                        out,
                        "RING CENTER {center} NORMAL {normal} INNER 0.0 OUTER {radius} T{material}"
                    )?;
                }
            }
        }
        Shapes::Cones(_) => return Err(io::Error::other("Tachyon knows no cone")),
        Shapes::Blocks(blocks) => blocks.iter().try_for_each(|block| write_block(block, out))?,
        Shapes::Mesh(mesh) => write_mesh(mesh, out)?,
    }
    writeln!(out, "END_SCENE")
}

fn write_block(block: &Block, out: &mut impl Write) -> io::Result<()> {
    let corner = |signs: usize| {
        [0, 1, 2].map(|i| {
            let part = |axis: usize| {
                let half = 0.5 * f64::from(block.size[axis]);
                block.axes[axis][i] * if signs >> axis & 1 == 1 { half } else { -half }
            };
            f64::from(block.center[i]) + part(0) + part(1) + part(2)
        })
    };
    // Corner numbers have one bit an axis; each face counter-clockwise seen from outside.
    for [a, b, c, d] in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|signs| words(corner(signs)));
            writeln!(out, "TRI V0 {p} V1 {q} V2 {r} T{}", block.material)?;
        }
    }
    Ok(())
}

fn write_mesh(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    for face in &mesh.faces {
        let [a, b, c] = face.map(|corner| words(mesh.positions[corner as usize]));
        let normal = |corner: u32| mesh.normals.get(corner as usize).map(|&normal| words(normal));
        match (normal(face[0]), normal(face[1]), normal(face[2])) {
            (Some(k), Some(l), Some(m)) => {
                writeln!(out, "STRI V0 {a} V1 {b} V2 {c} N0 {k} N1 {l} N2 {m} T0")?;
            }
            (None, _, _) | (_, None, _) | (_, _, None) => writeln!(out, "TRI V0 {a} V1 {b} V2 {c} T0")?,
        }
    }
    Ok(())
}
