//! Ray files: eight float32 a ray, which all programs trace.

use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use std::fs::File;
use std::io::BufWriter;
use std::io::Write;
use std::path::Path;

/// Origin, least t, direction, greatest t.
pub type RawRay = [f32; 8];

/// The four sets, from the most coherent to the least.
pub const SETS: [&str; 4] = ["primary", "shadow", "diffuse", "random"];

/// Whether a set asks for any hit rather than for the nearest.
pub fn is_occlusion(set: &str) -> bool {
    set == "shadow"
}

/// Whether successive rays of a set start and run alike.
pub fn is_coherent(set: &str) -> bool {
    matches!(set, "primary" | "shadow")
}

/// A ray as it is stored. A greatest t beyond single precision's range stands for none.
pub fn stored(ray: &Ray, t_min: f64, t_max: f64) -> RawRay {
    let [o, d] = [ray.origin, ray.direction].map(|v| v.to_array().map(|x| x as f32));
    [o[0], o[1], o[2], t_min as f32, d[0], d[1], d[2], t_max.min(1e30) as f32]
}

/// Stored rays in double precision.
#[derive(Debug, Default)]
pub struct Batch {
    rays: Vec<Ray>,
    t_min: Vec<f64>,
    t_max: Vec<f64>,
}

impl Batch {
    /// Takes these rays in the place of those before; their directions have length 1 again.
    pub fn set(&mut self, raw: &[RawRay]) {
        self.rays.clear();
        self.t_min.clear();
        self.t_max.clear();
        for raw in raw {
            let n = raw.map(f64::from);
            let direction = Vec3::new(n[4], n[5], n[6]).normalize();
            self.rays.push(Ray::new(Vec3::new(n[0], n[1], n[2]), direction));
            self.t_min.push(n[3]);
            self.t_max.push(n[7]);
        }
    }

    /// The rays, as a caster takes them.
    pub fn queries(&self) -> Queries<'_> {
        Queries { rays: &self.rays, t_min: &self.t_min, t_max: &self.t_max }
    }
}

/// Writes a set.
///
/// # Errors
/// What the system says.
pub fn write(path: &Path, rays: &[RawRay]) -> Result<(), String> {
    let told = |fault: std::io::Error| format!("{}: {fault}", path.display());
    let mut out = BufWriter::new(File::create(path).map_err(told)?);
    for number in rays.iter().flatten() {
        out.write_all(&number.to_le_bytes()).map_err(told)?;
    }
    out.flush().map_err(told)
}

/// Reads a set.
///
/// # Errors
/// What the system says.
pub fn read(path: &Path) -> Result<Vec<RawRay>, String> {
    let bytes = std::fs::read(path).map_err(|fault| format!("{}: {fault}", path.display()))?;
    let (numbers, _) = bytes.as_chunks::<4>();
    let numbers: Vec<f32> = numbers.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
    Ok(numbers.as_chunks::<8>().0.to_vec())
}

#[cfg(test)]
mod tests {
    use super::Batch;
    use super::read;
    use super::stored;
    use super::write;
    use dotray_geometry::Ray;
    use dotray_geometry::Vec3;

    #[test]
    fn rays_survive_the_file() {
        let ray = Ray::new(Vec3::new(1.0, 2.0, -3.0), Vec3::new(0.6, 0.0, -0.8));
        let rays = [stored(&ray, 0.0, 5.0), stored(&ray, 1.0, f64::INFINITY)];
        let path = std::env::temp_dir().join(format!("xtask-rays-{}", std::process::id()));
        write(&path, &rays).expect("the folder of temporary files can be written");
        assert_eq!(read(&path), Ok(rays.to_vec()));
        std::fs::remove_file(&path).expect("it is ours");
        let mut batch = Batch::default();
        batch.set(&rays);
        let again = batch.queries().query(0);
        assert!((again.ray.direction - ray.direction).length() < 1e-7);
        assert_eq!((again.ray.origin, again.t_min, again.t_max), (ray.origin, 0.0, 5.0));
    }
}
