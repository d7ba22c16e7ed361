//! Why a ray has its colour: everything that the renderer computed on the way, as data.
//!
//! [`Tracer::inspect`](crate::trace::Tracer::inspect) fills it in while the renderer itself runs: there is no second
//! implementation of the formula that could say something else.

use crate::light::Incident;
use crate::query::Crossing;
use crate::query::Nearest;
use crate::query::Tests;
use crate::shade::ShadePoint;
use crate::shapes::WorldSurface;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;

/// Why a ray was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RayKind {
    /// From the camera.
    Eye,
    /// Along r̂.
    Reflected,
    /// Along t̂.
    Refracted,
}

/// A ray and all that came of it.
#[derive(Clone, Debug)]
pub struct RayNode {
    /// Why it was sent.
    pub kind: RayKind,
    /// The ray, in the world.
    pub ray: Ray,
    /// How many bounces lie behind it.
    pub depth: u32,
    /// The product of the weights along its path.
    pub contribution: Vec3,
    /// What its colour is multiplied by where it was sent: kSpec·M_S or kTrans·M_S; 1 for an eye ray.
    pub weight: Vec3,
    /// The boxes and shapes that it was tested against.
    pub tests: Tests,
    /// What it met; `None` where it saw the background.
    pub meeting: Option<Meeting>,
    /// What it sees.
    pub color: Vec3,
}

/// A point that a ray met, and what each term of the formula gave there.
#[derive(Clone, Debug)]
pub struct Meeting {
    /// The shape and the place on it.
    pub nearest: Nearest,
    /// The point in the world and in the shape's own coordinates.
    pub surface: WorldSurface,
    /// The material's number in the resolved scene.
    pub material: u32,
    /// n̂: the shading normal, flipped where the ray leaves.
    pub normal: Vec3,
    /// The shape's own normal, flipped where the ray leaves.
    pub geometric_normal: Vec3,
    /// Whether the ray comes from outside.
    pub entering: bool,
    /// M_A, with the shape's own colour where it has one
    pub ambient: Vec3,
    /// T_C
    pub texture: Vec3,
    /// r̂
    pub mirrored: Vec3,
    /// M_E + M_A·L_G·T_C
    pub own_light: Vec3,
    /// The term of each light, and of each sample of an area light.
    pub lights: Vec<LightTerm>,
    /// The mirrored ray.
    pub reflected: Branch,
    /// The refracted ray.
    pub refracted: Branch,
}

/// What one point of a light gives to one point of a surface.
#[derive(Clone, Debug)]
pub struct LightTerm {
    /// The light's number in file order.
    pub light: u32,
    /// Which of its samples.
    pub sample: u32,
    /// Of how many; 1 for all but area lights.
    pub samples: u32,
    /// Direction, distance and strength; `None` where the light sends nothing here (outside of a spot's cone, behind
    /// a disc).
    pub incident: Option<Incident>,
    /// n̂·L̂
    pub cosine: f64,
    /// M_D·T_C·(n̂·L̂), before the light's strength.
    pub diffuse: Vec3,
    /// M_S·max(0, r̂·L̂)^(128·kSpec), before the light's strength.
    pub highlight: Vec3,
    /// What the light would give if nothing lay between.
    pub lit: Vec3,
    /// What lies between.
    pub shadow: Shadow,
    /// S_i
    pub filter: Vec3,
    /// The boxes and shapes that the shadow ray was tested against.
    pub tests: Tests,
}

/// What lies between a point and a light.
#[derive(Clone, Debug)]
pub enum Shadow {
    /// Nobody asked: the light would give nothing, or shadows are off.
    NotAsked,
    /// An opaque shape: its position and number (which one of several depends on the accelerator).
    Blocked {
        /// Its position.
        position: u32,
        /// Its number in file order.
        number: u32,
    },
    /// See-through surfaces, nearest first, with what each lets through; none where the way is free.
    Crossed(Vec<(Crossing, Vec3)>),
}

/// What became of a secondary ray.
#[derive(Clone, Debug)]
pub enum Branch {
    /// It was traced.
    Traced(Box<RayNode>),
    /// It was not.
    Ended(End),
}

/// Why no ray was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum End {
    /// The recursion limit was reached.
    Limit,
    /// The material reflects or transmits nothing.
    NoWeight,
    /// The contribution's largest channel lies below the threshold.
    Threshold {
        /// That channel.
        largest: f64,
    },
    /// Total internal reflection.
    TotalReflection,
}

impl Branch {
    /// What the ray adds to its sender: weight · colour; 0 where there is none.
    pub fn color(&self) -> Vec3 {
        match self {
            Self::Traced(node) => node.weight * node.color,
            Self::Ended(_) => Vec3::ZERO,
        }
    }
}

impl Meeting {
    /// M_E + M_A·L_G·T_C + Σ_i of the lights, in the renderer's order of addition.
    pub fn direct(&self) -> Vec3 {
        let mut sum = self.own_light;
        for terms in self.lights.chunk_by(|a, b| a.light == b.light) {
            match terms {
                [term] if term.samples == 1 => {
                    // A light that gives nothing is not added, not even as a 0.
                    if term.lit != Vec3::ZERO {
                        sum += term.lit * term.filter;
                    }
                }
                [first, ..] => {
                    let lit = terms.iter().filter(|term| term.lit != Vec3::ZERO);
                    let all = lit.fold(Vec3::ZERO, |all, term| all + term.lit * term.filter);
                    sum += all / f64::from(first.samples);
                }
                [] => {}
            }
        }
        sum
    }

    /// The whole formula, added up from its parts in the renderer's order: the ray's colour, bit for bit.
    pub fn sum(&self) -> Vec3 {
        let mut sum = self.direct();
        for branch in [&self.reflected, &self.refracted] {
            if matches!(branch, Branch::Traced(_)) {
                sum += branch.color();
            }
        }
        sum
    }
}

/// What is being filled in: the rays under way, the deepest last.
#[derive(Debug, Default)]
pub(crate) struct Inspector {
    open: Vec<RayNode>,
    /// The finished eye ray.
    pub root: Option<RayNode>,
}

impl Inspector {
    pub fn begin(&mut self, kind: RayKind, ray: Ray, depth: u32, contribution: Vec3, weight: Vec3) {
        let (tests, color) = (Tests::default(), Vec3::ZERO);
        self.open.push(RayNode { kind, ray, depth, contribution, weight, tests, meeting: None, color });
    }

    pub fn tests(&mut self, tests: Tests) {
        if let Some(node) = self.open.last_mut() {
            node.tests = tests;
        }
    }

    pub fn met(&mut self, nearest: Nearest, surface: WorldSurface, material: u32, point: &ShadePoint<'_>) {
        if let Some(node) = self.open.last_mut() {
            node.meeting = Some(Meeting {
                nearest,
                surface,
                material,
                normal: point.normal,
                geometric_normal: point.geometric_normal,
                entering: point.entering,
                ambient: point.ambient,
                texture: point.texture,
                mirrored: point.mirrored,
                own_light: Vec3::ZERO,
                lights: Vec::new(),
                reflected: Branch::Ended(End::Limit),
                refracted: Branch::Ended(End::Limit),
            });
        }
    }

    fn meeting(&mut self) -> Option<&mut Meeting> {
        self.open.last_mut()?.meeting.as_mut()
    }

    pub fn own_light(&mut self, color: Vec3) {
        if let Some(meeting) = self.meeting() {
            meeting.own_light = color;
        }
    }

    pub fn light(&mut self, term: LightTerm) {
        if let Some(meeting) = self.meeting() {
            meeting.lights.push(term);
        }
    }

    /// The shadow of the last light's term.
    pub fn shadow(&mut self, shadow: Shadow, filter: Vec3, tests: Tests) {
        if let Some(term) = self.meeting().and_then(|meeting| meeting.lights.last_mut()) {
            (term.shadow, term.filter, term.tests) = (shadow, filter, tests);
        }
    }

    pub fn ended(&mut self, kind: RayKind, end: End) {
        self.branch(kind, Branch::Ended(end));
    }

    fn branch(&mut self, kind: RayKind, branch: Branch) {
        if let Some(meeting) = self.meeting() {
            match kind {
                RayKind::Reflected => meeting.reflected = branch,
                RayKind::Refracted => meeting.refracted = branch,
                RayKind::Eye => {}
            }
        }
    }

    pub fn finish(&mut self, color: Vec3) {
        if let Some(mut node) = self.open.pop() {
            node.color = color;
            if self.open.is_empty() {
                self.root = Some(node);
            } else {
                self.branch(node.kind, Branch::Traced(Box::new(node)));
            }
        }
    }
}
