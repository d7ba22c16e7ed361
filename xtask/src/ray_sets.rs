//! The four sets of rays of a scene: what a picture asks, from its most coherent rays to its least.

use crate::random::Random;
use crate::rays::Batch;
use crate::rays::RawRay;
use crate::rays::stored;
use crate::write::HEIGHT;
use crate::write::WIDTH;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_render::Caster;
use dotray_scene::model::Camera;

/// The edge of the tiles in which eye rays are stored.
const TILE: u32 = 4;
/// How far from a surface rays leave it: scenes are about 1 in size, and single precision carries 1e-7.
const OFFSET: f64 = 1e-5;

/// The sets in the order of [`crate::rays::SETS`].
pub struct Sets(pub [Vec<RawRay>; 4]);

/// The eye rays in tiles of 4 × 4, along Morton's curve in each, so that 4, 8 and 16 successive rays are neighbours.
fn eye_rays(camera: &Camera) -> Vec<Ray> {
    let forward = camera.direction.normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let pixel = 2.0 * libm::tan(camera.half_angle) / f64::from(HEIGHT);
    let mut rays = Vec::with_capacity((WIDTH * HEIGHT) as usize);
    for tile in 0..(WIDTH / TILE) * (HEIGHT / TILE) {
        let (left, low) = (tile % (WIDTH / TILE) * TILE, tile / (WIDTH / TILE) * TILE);
        for k in 0..TILE * TILE {
            let x = left + (k & 1 | k >> 1 & 2);
            let y = low + (k >> 1 & 1 | k >> 2 & 2);
            let across = (f64::from(x) + 0.5 - 0.5 * f64::from(WIDTH)) * pixel;
            let along = (f64::from(y) + 0.5 - 0.5 * f64::from(HEIGHT)) * pixel;
            rays.push(Ray::new(camera.position, (forward + right * across + up * along).normalize()));
        }
    }
    rays
}

/// What leaves a point that an eye ray has hit: towards the light where that is on the outer side, and diffusely.
fn leaving(ray: &Ray, normal: Vec3, t: f64, light: Vec3, random: &mut Random) -> (Option<RawRay>, RawRay) {
    let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
    let point = ray.at(t) + normal * OFFSET;
    let to_light = light - point;
    let distance = to_light.length();
    let lit = to_light.dot(normal) > 0.0;
    let shadow = lit.then(|| stored(&Ray::new(point, to_light / distance), OFFSET, distance));
    let bounced = (normal + Vec3::from_array(random.direction())).normalize_or(normal);
    (shadow, stored(&Ray::new(point, bounced), OFFSET, f64::INFINITY))
}

/// Makes the sets: eye rays of the camera, rays from their hits to the light and in random directions, and rays
/// between random points of the unit cube.
pub fn make(caster: &Caster, camera: &Camera, light: Vec3) -> Sets {
    let mut random = Random::new(88_172_645_463_325_252);
    let primary: Vec<_> = eye_rays(camera).iter().map(|ray| stored(ray, 0.0, f64::INFINITY)).collect();
    let (mut shadow, mut diffuse) = (Vec::new(), Vec::new());
    let mut batch = Batch::default();
    for chunk in primary.chunks(1024) {
        // The rays as the file has them, so that what leaves their hits belongs to them.
        batch.set(chunk);
        let queries = batch.queries();
        for (ray, found) in queries.rays.iter().zip(caster.nearest(&queries, true)) {
            let Some(found) = found else { continue };
            let normal = caster.surface(ray, &found).geometric_normal;
            let (to_light, bounced) = leaving(ray, normal, found.hit.t, light, &mut random);
            shadow.extend(to_light);
            diffuse.push(bounced);
        }
    }
    let between = |_| {
        let (from, to) = (Vec3::from_array(random.point()), Vec3::from_array(random.point()));
        stored(&Ray::new(from, (to - from).normalize_or(Vec3::X)), OFFSET, f64::INFINITY)
    };
    let unordered = (0..WIDTH * HEIGHT / 4).map(between).collect();
    Sets([primary, shadow, diffuse, unordered])
}
