//! The scenes that the bench makes itself, the same on every machine.
//!
//! Numbers are single precision, so that programs that take raw floats get the very scene that the texts tell.

mod catalogue;
mod knot;
mod particles;
mod rods;

pub use catalogue::make;
pub use catalogue::raw_kind;

/// Where the eye is and what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The eye.
    pub eye: [f64; 3],
    /// What it looks at.
    pub at: [f64; 3],
    /// The picture's vertical angle in degrees.
    pub angle: f64,
}

impl View {
    /// What is up in all scenes.
    pub const UP: [f64; 3] = [0.0, 1.0, 0.0];

    /// The unit vector of the view.
    pub fn direction(&self) -> [f64; 3] {
        unit([0, 1, 2].map(|i| self.at[i] - self.eye[i]))
    }
}

/// What a shape is made of: diffuse, or diffuse and mirror.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Its colour.
    pub color: [f64; 3],
    /// How much of a mirror it is.
    pub reflection: f64,
}

/// How much of its colour a material scatters, in every scene.
pub const DIFFUSE: f64 = 0.9;
/// The ambient light, in every scene.
pub const AMBIENT: f64 = 0.1;
/// What rays see that meet nothing.
pub const BACKGROUND: [f64; 3] = [0.1, 0.1, 0.15];
/// The one light, white.
pub const LIGHT: [f64; 3] = [3.0, 5.0, 4.0];

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub center: [f32; 3],
    /// Its radius.
    pub radius: f32,
    /// Its material.
    pub material: u8,
}

/// A closed cylinder or cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// The centre of its base disc.
    pub base: [f32; 3],
    /// The other end of its axis: a cone's apex.
    pub top: [f32; 3],
    /// Its radius.
    pub radius: f32,
    /// Its material.
    pub material: u8,
}

/// A turned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its centre.
    pub center: [f32; 3],
    /// Its edges.
    pub size: [f32; 3],
    /// Its axes, orthonormal.
    pub axes: [[f64; 3]; 3],
    /// Its material.
    pub material: u8,
}

/// Triangles that share vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Where the vertices are.
    pub positions: Vec<[f32; 3]>,
    /// Their normals; empty for a flat mesh.
    pub normals: Vec<[f32; 3]>,
    /// The triangles.
    pub faces: Vec<[u32; 3]>,
}

/// What a scene holds: one kind of shape.
#[derive(Clone, Debug, PartialEq)]
pub enum Shapes {
    /// Spheres.
    Balls(Vec<Ball>),
    /// Cylinders.
    Cylinders(Vec<Rod>),
    /// Cones.
    Cones(Vec<Rod>),
    /// Boxes.
    Blocks(Vec<Block>),
    /// Triangles, all of the first material.
    Mesh(Mesh),
}

#[cfg(test)]
impl Shapes {
    /// How many shapes there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Balls(list) => list.len(),
            Self::Cylinders(list) | Self::Cones(list) => list.len(),
            Self::Blocks(list) => list.len(),
            Self::Mesh(mesh) => mesh.faces.len(),
        }
    }
}

/// A scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// By which law it is made.
    pub law: String,
    /// The camera.
    pub view: View,
    /// The materials.
    pub materials: Vec<Material>,
    /// The shapes.
    pub shapes: Shapes,
}

/// The vector at length 1.
pub fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| x / length)
}

/// The vector product.
pub fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Two unit vectors that stand upright on a unit vector and on each other, so that (first, `y`, second) is
/// right-handed.
pub fn across(y: [f64; 3]) -> [[f64; 3]; 2] {
    let other = if y[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = unit(cross(y, other));
    [x, cross(x, y)]
}
