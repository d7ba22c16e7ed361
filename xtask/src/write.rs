//! Scenes as the texts and raw floats that the programs read.

mod povray;
mod raw;
mod ray;
mod tachyon;

use crate::scenes::Scene;
use std::fs::File;
use std::io;
use std::io::BufWriter;
use std::io::Write;
use std::path::Path;

pub use raw::camera;

/// Columns of every picture.
pub const WIDTH: u32 = 1024;
/// Rows of every picture.
pub const HEIGHT: u32 = 768;
/// Levels of rays: one eye ray and four bounces.
pub const LEVELS: u32 = 5;

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The `.ray` language.
    Ray,
    /// Tachyon's.
    Tachyon,
    /// POV-Ray's.
    PovRay,
    /// Raw float32 of the shapes.
    Raw,
    /// Eye, target, up, angle, light in text.
    Camera,
}

impl Kind {
    /// The extension of the file of a scene; `None` where there is no such file for its shapes.
    pub fn extension(self, name: &str) -> Option<&'static str> {
        match self {
            Self::Ray => Some("ray"),
            // Tachyon knows no cone.
            Self::Tachyon => (!name.starts_with("cone")).then_some("dat"),
            Self::PovRay => Some("pov"),
            Self::Raw => crate::scenes::raw_kind(name),
            Self::Camera => Some("cam"),
        }
    }
}

/// Writes a scene to a file, first under another name, so that no half file is taken for a whole one.
///
/// # Errors
/// Tells what the system says.
pub fn write(scene: &Scene, kind: Kind, path: &Path) -> Result<(), String> {
    let half = path.with_extension("half");
    let all = || -> io::Result<()> {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(&half)?);
        match kind {
            Kind::Ray => ray::write(scene, &mut out)?,
            Kind::Tachyon => tachyon::write(scene, &mut out)?,
            Kind::PovRay => povray::write(scene, &mut out)?,
            Kind::Raw => raw::write(scene, &mut out)?,
            Kind::Camera => raw::write_camera(scene, &mut out)?,
        }
        out.flush()?;
        std::fs::rename(&half, path)
    };
    all().map_err(|fault| format!("{}: {fault}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::Kind;
    use crate::scenes::make;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;

    fn text(name: &str, kind: Kind) -> String {
        let path = std::env::temp_dir().join(format!("xtask-write-{name}-{kind:?}-{}", std::process::id()));
        let scene = make(name).expect("the name is in the catalogue");
        super::write(&scene, kind, &path).expect("the folder of temporary files can be written");
        let bytes = std::fs::read(&path).expect("it was written");
        std::fs::remove_file(&path).expect("it is ours");
        String::from_utf8_lossy(&bytes).into_owned()
    }

    #[test]
    fn ray_files_hold_every_shape_and_load_without_a_word() {
        for (name, count) in
            [("rnd2", 100), ("pack2", 125), ("cyl2", 100), ("cone2", 100), ("box2", 100), ("knotc", 4098)]
        {
            let loaded = load_text(name, text(name, Kind::Ray), &Disk, &LoadOptions::default());
            assert!(loaded.diagnostics.is_empty(), "{name}: {:?}", loaded.diagnostics.first());
            let scene = loaded.scene.expect("no errors");
            let resolved = dotray_scene::resolve::resolve(scene).resolved.expect("no errors");
            assert_eq!(resolved.shape_count, count, "{name}");
        }
    }

    #[test]
    fn peers_files_hold_every_shape() {
        let count = |name, kind, word: &str| text(name, kind).matches(word).count();
        assert_eq!(count("rnd2", Kind::Tachyon, "\nSPHERE "), 100);
        assert_eq!(count("cyl2", Kind::Tachyon, "\nFCYLINDER "), 100);
        assert_eq!(count("box2", Kind::Tachyon, "\nTRI "), 1200);
        assert_eq!(count("rnd2", Kind::PovRay, "sphere{"), 100);
        assert_eq!(count("cone2", Kind::PovRay, "cone{"), 100);
        assert_eq!(count("box2", Kind::PovRay, "box{"), 100);
        assert_eq!(Kind::Tachyon.extension("cone5"), None);
    }
}
