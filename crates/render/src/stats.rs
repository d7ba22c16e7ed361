//! What a picture cost.

/// Rays, tests, bytes and seconds. Counts do not depend on the machine; seconds do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// Rays from the eye.
    pub eye_rays: u64,
    /// Rays to lights.
    pub shadow_rays: u64,
    /// Mirrored rays.
    pub reflected_rays: u64,
    /// Refracted rays.
    pub refracted_rays: u64,
    /// Boxes (or cells) of the accelerator that were tested.
    pub box_tests: u64,
    /// Shapes that were tested.
    pub shape_tests: u64,
    /// Bytes by part.
    pub memory: Vec<MemoryPart>,
    /// Seconds by stage, in the order in which the stages ran.
    pub seconds: Vec<(&'static str, f64)>,
}

/// The bytes that a part of the program holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryPart {
    /// Its name.
    pub name: &'static str,
    /// Its bytes.
    pub bytes: u64,
}

impl Stats {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.eye_rays + self.shadow_rays + self.reflected_rays + self.refracted_rays
    }

    /// Adds another part's counts.
    pub fn add_counts(&mut self, other: &Self) {
        self.eye_rays += other.eye_rays;
        self.shadow_rays += other.shadow_rays;
        self.reflected_rays += other.reflected_rays;
        self.refracted_rays += other.refracted_rays;
        self.box_tests += other.box_tests;
        self.shape_tests += other.shape_tests;
    }
}
