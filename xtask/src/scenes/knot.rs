//! A bumpy torus knot on a floor: a mesh of any size, flat or smooth.

use crate::scenes::Mesh;
use crate::scenes::cross;
use crate::scenes::unit;
use libm::cos;
use libm::sin;
use std::f64::consts::TAU;

/// The knot's centre line: three times around, twice through.
fn line(turn: f64) -> [f64; 3] {
    let (around, through) = (2.0 * turn, 3.0 * turn);
    let radius = 2.0 + cos(through);
    [radius * cos(around), -sin(through), radius * sin(around)]
}

/// A point of the tube around the line: `turn` along it, `angle` around it.
fn point(turn: f64, angle: f64) -> [f64; 3] {
    let small = 1e-4;
    let (behind, before, center) = (line(turn - small), line(turn + small), line(turn));
    let along = unit([0, 1, 2].map(|i| before[i] - behind[i]));
    let outward = unit(cross(along, [0.0, 1.0, 0.0]));
    let upward = cross(outward, along);
    let bumps = 0.05 * sin(24.0 * turn) * sin(6.0 * angle) + 0.01 * sin(48.0 * turn + 3.0 * angle);
    let radius = 0.45 + bumps;
    [0, 1, 2].map(|i| center[i] + radius * (cos(angle) * outward[i] + sin(angle) * upward[i]))
}

/// The outward normal of the tube.
fn normal(turn: f64, angle: f64) -> [f64; 3] {
    let small = 1e-5;
    let slope = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let along = slope(point(turn + small, angle), point(turn - small, angle));
    let around = slope(point(turn, angle + small), point(turn, angle - small));
    unit(cross(along, around))
}

/// The knot with `rings` rings of `sides` quadrilaterals, each cut in two, and a floor of two triangles. It fills the
/// unit cube's width.
pub fn knot(rings: u32, sides: u32, smooth: bool) -> Mesh {
    // The knot's half width is 2 + 1 + 0.45 and the bumps.
    let to_cube = |p: [f64; 3]| p.map(|x| (0.5 + x / 7.1) as f32);
    let mut mesh = Mesh::default();
    for ring in 0..rings {
        for side in 0..sides {
            let (turn, angle) =
                (TAU * f64::from(ring) / f64::from(rings), TAU * f64::from(side) / f64::from(sides));
            mesh.positions.push(to_cube(point(turn, angle)));
            if smooth {
                mesh.normals.push(normal(turn, angle).map(|x| x as f32));
            }
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let at = |r: u32, s: u32| (r % rings) * sides + s % sides;
            let [a, b, c, d] =
                [at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)];
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let lowest = mesh.positions.iter().fold(1.0_f32, |low, position| low.min(position[1]));
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([
        [-3.0, lowest, -3.0],
        [-3.0, lowest, 4.0],
        [4.0, lowest, 4.0],
        [4.0, lowest, -3.0],
    ]);
    if smooth {
        mesh.normals.extend([[0.0, 1.0, 0.0]; 4]);
    }
    mesh.faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    mesh
}

#[cfg(test)]
mod tests {
    use super::knot;
    use crate::scenes::cross;

    #[test]
    fn faces_look_outward_and_the_tube_is_closed() {
        let mesh = knot(512, 68, true);
        assert_eq!(mesh.faces.len(), 2 * 512 * 68 + 2);
        for face in &mesh.faces {
            let [a, b, c] = face.map(|i| mesh.positions[i as usize].map(f64::from));
            let edge = |to: [f64; 3]| [0, 1, 2].map(|i| to[i] - a[i]);
            let outward = cross(edge(b), edge(c));
            for corner in face {
                let normal = mesh.normals[*corner as usize].map(f64::from);
                let cosine: f64 = (0..3).map(|i| outward[i] * normal[i]).sum();
                assert!(cosine > 0.0, "{face:?}");
            }
        }
        let inside = |x: &f32| (-1e-6..=1.0 + 1e-6).contains(x);
        assert!(mesh.positions[..512 * 68].iter().flatten().all(inside));
    }
}
