//! The shading formula of SPEC 6, one function a term:
//!
//! ```text
//! Color = M_E + M_A·L_G·T_C
//!       + Σ_i L_i·S_i·[ M_D·T_C·max(0, n̂·L̂) + M_S·max(0, r̂·L̂)^(128·kSpec) ]·F_SPOT·F_ATTEN
//!       + kSpec ·M_S·Trace(P, r̂)
//!       + kTrans·M_S·Trace(P, t̂)
//! ```

use crate::leaving::Leaving;
use crate::light::Incident;
use crate::light::MOST;
use crate::options::TextureFilter;
use crate::query::Nearest;
use crate::shapes::OwnColor;
use crate::solid;
use crate::world::World;
use dotray_geometry::Ray;
use dotray_geometry::Surface;
use dotray_geometry::Vec3;
use dotray_scene::model::Tint;
use dotray_scene::resolved::ResolvedMaterial;

/// A point hit, with all that the terms of the formula share.
#[derive(Clone, Copy, Debug)]
pub struct ShadePoint<'a> {
    /// The surface's material.
    pub material: &'a ResolvedMaterial,
    /// M_A, with the shape's own colour where it has one
    pub ambient: Vec3,
    /// M_D, likewise
    pub diffuse: Vec3,
    /// P
    pub point: Vec3,
    /// d̂: the ray's direction.
    pub direction: Vec3,
    /// n̂: the shading normal, flipped where the ray leaves.
    pub normal: Vec3,
    /// The shape's own normal, flipped where the ray leaves: it faces the viewer always.
    pub geometric_normal: Vec3,
    /// Whether the ray comes from outside.
    pub entering: bool,
    /// T_C
    pub texture: Vec3,
    /// T_C for highlights and emission, where the dialect's textures colour them: else 1.
    pub texture_on_all: Vec3,
    /// r̂: the mirrored direction.
    pub mirrored: Vec3,
    /// Which rays that start here do not meet the shape again.
    leaving: Leaving,
}

/// [`log2_above`] is less than 0.11 above the logarithm: a summand 2^-55.2 times the other at most is lost.
const LOST: f64 = 55.2;

/// A number above the binary logarithm of a positive number, by 0.11 at most where that is normal: the exponent and the
/// tangent at 1.5 of the rest, which lies above the curve.
fn log2_above(x: f64) -> f64 {
    let bits = x.to_bits();
    let exponent = (bits >> 52) as f64 - 1023.0;
    let rest = f64::from_bits(bits & ((1 << 52) - 1) | (1023 << 52));
    exponent + 0.585 + (rest - 1.5) * 0.9618
}

/// The slope of a texture taken as a height, in object space: the surface rises by it a texel.
fn slope_of_image(
    world: &World,
    position: u32,
    surface: &Surface,
    texture: u32,
    filter: TextureFilter,
) -> Vec3 {
    let Some(image) = world.textures.get(texture as usize) else { return Vec3::ZERO };
    let Some([along_s, along_t]) = world.caster.shapes.texture_axes(position, surface) else {
        return Vec3::ZERO;
    };
    let slopes = image.slopes(surface.texcoord.get(), filter);
    along_s * slopes.x + along_t * slopes.y
}

impl<'a> ShadePoint<'a> {
    /// The point where `ray` met `nearest`.
    pub(crate) fn new(world: &'a World, ray: &Ray, nearest: &Nearest, filter: TextureFilter) -> Self {
        let material = &world.materials[world.caster.shapes.material(nearest.position) as usize];
        let (ambient, diffuse) = match world.caster.shapes.own_color(nearest.position, ray) {
            OwnColor::No => (material.ambient, material.diffuse),
            OwnColor::Times(color) => (material.ambient * color, material.diffuse * color),
            OwnColor::Instead(color) => (color, color),
        };
        let surface = world.caster.shapes.surface(nearest.position, ray, nearest.hit);
        let procedural = &material.procedural;
        let plain = procedural.bumps.is_empty()
            && surface.in_object.shading_normal == surface.in_object.geometric_normal;
        let outward = if plain {
            surface.geometric_normal
        } else {
            let normal = surface.in_object.shading_normal.normalize();
            let of_image =
                |number| slope_of_image(world, nearest.position, &surface.in_object, number, filter);
            let leaned = solid::bumped(&procedural.bumps, normal, surface.in_object.point, of_image);
            world.caster.shapes.world_normal(nearest.position, leaned)
        };
        let image = material.texture.and_then(|number| world.textures.get(number as usize));
        let texture = image.map_or(Vec3::ONE, |image| image.color(surface.in_object.texcoord.get(), filter))
            * solid::color(&procedural.solids, surface.in_object.point);
        let direction = ray.direction;
        let entering = direction.dot(surface.geometric_normal) <= 0.0;
        let facing = |normal: Vec3| if entering { normal } else { -normal };
        let normal = facing(outward);
        Self {
            material,
            ambient,
            diffuse,
            point: surface.point,
            direction,
            normal,
            geometric_normal: facing(surface.geometric_normal),
            entering,
            texture,
            texture_on_all: if material.texture_on_all_light { texture } else { Vec3::ONE },
            mirrored: direction - normal * (2.0 * direction.dot(normal)),
            leaving: world.caster.shapes.leaving(nearest.position),
        }
    }

    /// The position of the shape if a ray from here in this direction cannot meet it again.
    #[inline]
    pub fn left_by(&self, direction: Vec3) -> u32 {
        let outward = if self.entering { self.geometric_normal } else { -self.geometric_normal };
        self.leaving.left_by(direction, outward)
    }

    /// M_E + M_A·L_G·T_C
    pub fn own_light(&self, global_ambient: Vec3) -> Vec3 {
        self.material.emissive * self.texture_on_all + self.ambient(global_ambient)
    }

    /// M_A·L·T_C
    pub fn ambient(&self, light: Vec3) -> Vec3 {
        self.ambient * light * self.texture
    }

    /// L_i·[ M_D·T_C·max(0, n̂·L̂) + M_S·max(0, r̂·L̂)^(128·kSpec) ]·F_SPOT·F_ATTEN where n̂·L̂ > 0, else 0:
    /// what the light would give if nothing lay between.
    pub fn lit(&self, incident: &Incident, tint: &Tint) -> Vec3 {
        let cosine = self.normal.dot(incident.towards);
        if cosine <= 0.0 { Vec3::ZERO } else { self.lit_by(incident, cosine, tint) }
    }

    /// The same where n̂·L̂ is known and not at most 0.
    pub fn lit_by(&self, incident: &Incident, cosine: f64, tint: &Tint) -> Vec3 {
        let diffuse = self.diffuse(cosine) * tint.diffuse;
        if self.highlight_is_lost(incident.towards, diffuse, tint) {
            return diffuse * incident.strength;
        }
        (diffuse + self.highlight(incident.towards) * tint.specular) * incident.strength
    }

    /// Whether rounding takes the whole highlight off again where it is added to `beside`, so that nobody need know it:
    /// by far the most points lie outside of the highlight, and a power costs more than all other terms together.
    fn highlight_is_lost(&self, towards_light: Vec3, beside: Vec3, tint: &Tint) -> bool {
        let specular = self.material.specular * self.texture_on_all * tint.specular;
        let (cosine, shininess) = (self.mirrored.dot(towards_light), self.material.shininess);
        let (most, least) = (specular.abs().max_element(), beside.min_element());
        if cosine <= 0.0 || least <= 0.0 || !most.is_finite() {
            return false;
        }
        // A summand below 2^-54 of the other is lost; one power of two more is for what rounds on the way here.
        shininess * log2_above(cosine) + log2_above(most) < log2_above(least) - LOST
    }

    /// M_D·T_C·(n̂·L̂)
    pub fn diffuse(&self, cosine: f64) -> Vec3 {
        self.diffuse * self.texture * cosine
    }

    /// M_S·max(0, r̂·L̂)^(128·kSpec), with x^0 = 1.
    pub fn highlight(&self, towards_light: Vec3) -> Vec3 {
        let specular = self.material.specular;
        if specular == Vec3::ZERO {
            return Vec3::ZERO;
        }
        // What the power would give: by far the most points lie outside of the highlight.
        let specular = specular * self.texture_on_all;
        let (cosine, shininess) = (self.mirrored.dot(towards_light), self.material.shininess);
        if shininess == 0.0 {
            return specular;
        }
        if cosine <= 0.0 && shininess > 0.0 {
            return Vec3::ZERO;
        }
        // Rounding may leave a cosine above 1, whose power has no bound.
        specular * libm::pow(cosine.max(0.0), shininess).min(MOST)
    }

    /// The mirrored ray.
    pub fn reflected_ray(&self) -> Ray {
        Ray::new(self.point, self.mirrored.normalize())
    }

    /// The ray that Snell's law lets in or out, one side being air; `None` on total internal reflection.
    pub fn refracted_ray(&self) -> Option<Ray> {
        let index = self.material.index_of_refraction;
        let eta = if self.entering { 1.0 / index } else { index };
        // A shading normal that faces away near a silhouette would bend the ray to the wrong side.
        let normal = if self.direction.dot(self.normal) >= 0.0 { self.geometric_normal } else { self.normal };
        let cos_in = -self.direction.dot(normal);
        let cos_out_squared = 1.0 - eta * eta * (1.0 - cos_in * cos_in);
        if cos_out_squared < 0.0 {
            return None;
        }
        let direction = self.direction * eta + normal * (eta * cos_in - cos_out_squared.sqrt());
        Some(Ray::new(self.point, direction.normalize()))
    }
}

#[cfg(test)]
mod tests {
    use super::LOST;
    use super::log2_above;

    #[test]
    fn the_quick_logarithm_lies_above() {
        for i in 0..200_000 {
            let x = libm::exp(f64::from(i - 100_000) * 1e-3);
            let above = log2_above(x) - libm::log2(x);
            assert!((0.0..0.11).contains(&above), "{x}: {above}");
        }
        // The least normal number; what lies below it is taken for larger than it is.
        assert!(log2_above(f64::from_bits(1)) >= -1074.0);
    }

    #[test]
    fn what_is_lost_changes_no_sum() {
        let summand = libm::exp2(0.11 - LOST);
        for beside in [1.0, 1.0_f64.next_down(), 1.5, 0.1, 1e-300] {
            assert_eq!((beside + beside * summand, beside - beside * summand), (beside, beside));
        }
    }
}
