//! A tracer whose refracted rays go a wrong way on purpose: for wrong variants only.
//!
//! The renderer answers for each ray what lies there and what the lights give; only which ray goes on, and where, is
//! decided here.

use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_image::Channels;
use dotray_image::Image;
use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::inspect::Meeting;
use dotray_render::trace::Tracer;
use dotray_scene::resolved::ResolvedMaterial;

/// What a ray meets where it is to be bent.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The ray's direction, of length 1.
    pub direction: Vec3,
    /// The normal away from the shape's inside, of length 1.
    pub outward: Vec3,
    /// Whether the ray comes from outside.
    pub entering: bool,
    /// The material's index of refraction.
    pub index: f64,
}

/// Where a refracted ray goes; `None` where there is none.
pub type Bend = fn(&Surface) -> Option<Vec3>;

/// Snell's law with the normal and the ratio of indices that somebody takes.
pub fn snell(direction: Vec3, normal: Vec3, eta: f64) -> Option<Vec3> {
    let cos_in = -direction.dot(normal);
    let cos_out_squared = 1.0 - eta * eta * (1.0 - cos_in * cos_in);
    (cos_out_squared >= 0.0).then(|| direction * eta + normal * (eta * cos_in - cos_out_squared.sqrt()))
}

/// The picture with rays bent like this. `materials` are those of the scene that the world was made of.
///
/// # Errors
/// Where it would be the truth, or is more than a lesson needs.
pub fn picture(
    world: &World,
    materials: &[ResolvedMaterial],
    options: &Options,
    bend: Bend,
) -> Result<Image, String> {
    if options.antialias != Antialias::None || options.crop.is_some() || options.transparent {
        return Err("rays are bent in plain pictures only".to_owned());
    }
    if materials.iter().all(|material| material.transmission == Vec3::ZERO) {
        return Err("there is no glass".to_owned());
    }
    let here = Options { recursion: 0, ..options.clone() };
    let tracer = Tracer::new(world, &here, dotray_accel::simd::level());
    let mut bent = Bent { tracer, materials, options, bend };
    let camera = Camera::new(world.camera(), options.width, options.height);
    let (width, height) = (options.width as usize, options.height as usize);
    let mut image = Image::new(width, height, Channels::Rgb).map_err(|error| error.to_string())?;
    for (row, j) in (0..options.height).rev().enumerate() {
        for i in 0..options.width {
            let ray = camera.ray(f64::from(i) + 0.5, f64::from(j) + 0.5);
            let [r, g, b] = bent.color(ray).to_array().map(|x| x as f32);
            image.set_pixel(i as usize, row, [r, g, b, 1.0]);
        }
    }
    Ok(image)
}

struct Bent<'a> {
    tracer: Tracer<'a>,
    materials: &'a [ResolvedMaterial],
    options: &'a Options,
    bend: Bend,
}

impl Bent<'_> {
    /// What a ray sees: a list of rays under way, not recursion, as the limit may be any number.
    fn color(&mut self, eye_ray: Ray) -> Vec3 {
        let mut sum = Vec3::ZERO;
        let mut open = vec![(eye_ray, Vec3::ONE, 0)];
        while let Some((ray, contribution, depth)) = open.pop() {
            let Some(node) = self.tracer.inspect(ray) else { continue };
            sum += contribution * node.color;
            let Some(met) = &node.meeting else { continue };
            let Some(material) = self.materials.get(met.material as usize) else { continue };
            if depth >= self.options.recursion {
                continue;
            }
            let ways = [
                (material.reflection, Some(met.mirrored)),
                (material.transmission, self.bent(ray.direction, met, material)),
            ];
            for (weight, direction) in ways {
                let product = contribution * weight;
                let largest = product.max_element();
                let worthy = largest > 0.0 && largest >= self.options.threshold;
                if let Some(direction) = direction.filter(|_| worthy) {
                    open.push((Ray::new(met.surface.point, direction.normalize()), product, depth + 1));
                }
            }
        }
        sum
    }

    fn bent(&self, direction: Vec3, met: &Meeting, material: &ResolvedMaterial) -> Option<Vec3> {
        let outward = if met.entering { met.normal } else { -met.normal };
        let index = material.index_of_refraction;
        (self.bend)(&Surface { direction, outward, entering: met.entering, index })
    }
}
