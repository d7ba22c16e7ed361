//! Terms of the formula that are missing or wrong, and wrong options.

use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::Shadows;
use dotray_render::TextureFilter;
use dotray_scene::Resolved;
use dotray_scene::model::Color;
use dotray_scene::resolved::ResolvedMaterial;

pub fn shadows_off(options: &mut Options) {
    options.shadows = Shadows::Off;
}

pub fn shadows_opaque(options: &mut Options) {
    options.shadows = Shadows::Opaque;
}

pub fn one_bounce_less(options: &mut Options) {
    options.recursion = options.recursion.saturating_sub(1);
}

pub fn one_bounce_more(options: &mut Options) {
    options.recursion = options.recursion.saturating_add(1);
}

pub fn no_cutoff(options: &mut Options) {
    options.threshold = 0.0;
}

pub fn nearest_texel(options: &mut Options) {
    options.texture_filter = TextureFilter::Nearest;
}

pub fn no_oversampling(options: &mut Options) {
    options.antialias = Antialias::None;
}

pub fn corners_only(options: &mut Options) {
    if let Antialias::Adaptive { depth, .. } = &mut options.antialias {
        *depth = 0;
    }
}

pub fn no_ambient(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.ambient = Color::ZERO;
}

pub fn ambient_per_light(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.ambient *= resolved.lights.len() as f64;
}

fn materials(resolved: &mut Resolved, change: impl Fn(&mut ResolvedMaterial)) {
    resolved.materials.iter_mut().for_each(change);
}

pub fn no_emission(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.emissive = Color::ZERO);
}

pub fn no_diffuse(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.diffuse = Color::ZERO);
}

pub fn no_highlight(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.specular = Color::ZERO);
}

pub fn exponent_without_128(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.shininess /= 128.0);
}

/// (n·h)^m is close to (r·L)^(m/4).
pub fn half_vector(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.shininess /= 4.0);
}

pub fn exponent_doubled(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.shininess *= 2.0);
}

pub fn no_reflection(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.reflection = Color::ZERO);
}

pub fn no_refraction(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.transmission = Color::ZERO);
}

pub fn no_bending(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.index_of_refraction = 1.0);
}

pub fn ratio_inverted(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| {
        let inverse = 1.0 / material.index_of_refraction;
        if inverse.is_finite() {
            material.index_of_refraction = inverse;
        }
    });
}

pub fn no_texture(resolved: &mut Resolved, _: (u32, u32)) {
    materials(resolved, |material| material.texture = None);
}

pub fn black_sky(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.secondary_background = Color::ZERO;
}
