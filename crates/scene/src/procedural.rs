//! The clauses of a material's `!string!`: 3-D textures and bumps (SPEC 7), as data.

use dotray_geometry::Vec3;

/// A 3-D texture: `color2 + w * (color - color2)` with the pattern's weight w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Which weight.
    pub pattern: Pattern,
    /// q = scale · p.
    pub scale: f64,
    /// 1 … 30.
    pub octaves: u32,
    /// Where w = 1.
    pub color: Vec3,
    /// Where w = 0.
    pub color2: Vec3,
}

/// The four patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// clamp(½ + ½ fbm(q), 0, 1)
    Noise,
    /// ½ + ½ sin(π (q_x + 2 turb(q)))
    Marble,
    /// frac(√(q_x² + q_z²) + 0.2 fbm(q))
    Wood,
    /// 1 on even cells, 0 on odd ones
    Checker,
}

/// A bump: the normal leans by the slopes of h(p) = height · fbm(scale · p).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Cells a unit.
    pub scale: f64,
    /// 1 … 30.
    pub octaves: u32,
    /// The function's size.
    pub height: f64,
}

/// All clauses of one string, in its order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Procedural {
    /// Their colours multiply.
    pub solids: Vec<Solid>,
    /// Their gradients add.
    pub bumps: Vec<Bump>,
}
