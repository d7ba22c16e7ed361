//! Materials and textures of all files in one list each, with the formula's own quantities.

use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::dialect::Conventions;
use crate::dialect::Dialect;
use crate::model::BumpImage;
use crate::model::Material;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::Weights;
use crate::number::General;
use crate::procedural::Bump;
use crate::procedural::Procedural;
use crate::procedural::parse_clauses;
use crate::resolved::ResolvedMaterial;
use crate::resolved::ResolvedTexture;
use crate::span::FileId;
use dotray_geometry::Vec3;
use std::path::Path;
use std::path::PathBuf;

/// The materials and textures of all files.
#[derive(Debug)]
pub struct Materials {
    /// The last one is the default material.
    pub materials: Vec<ResolvedMaterial>,
    pub textures: Vec<ResolvedTexture>,
    /// For each file the number of its first material.
    pub bases: Vec<u32>,
}

/// Gathers and checks them.
pub fn resolve(files: &[SceneFile], sink: &mut Sink) -> Materials {
    let mut all = Materials { materials: Vec::new(), textures: Vec::new(), bases: Vec::new() };
    for file in files {
        let texture_base = all.textures.len() as u32;
        all.bases.push(all.materials.len() as u32);
        let textures = file.textures.iter().map(|placed| resolve_texture(&file.path, file.dialect, placed));
        all.textures.extend(textures);
        for placed in &file.materials {
            let texture = check_texture(placed, file.textures.len(), sink).map(|tn| texture_base + tn);
            let mut material = resolve_material(placed, texture, file.dialect.conventions(), sink);
            let bump = placed.value.bump.filter(|bump| (bump.texture as usize) < file.textures.len());
            if let Some(BumpImage { texture, scale }) = bump {
                material.procedural.bumps.push(Bump::Image { texture: texture_base + texture, scale });
            }
            all.materials.push(material);
        }
    }
    all.materials.push(default_material());
    all
}

/// Where the image of a `#texture` of the file at `scene_path` may lie: beside that file, else in the working
/// directory; for a lenient dialect also in the folders above, where courses' programs ran.
pub fn resolve_texture(scene_path: &Path, dialect: Dialect, placed: &Placed<String>) -> ResolvedTexture {
    const ABOVE: usize = 3;
    let name = &placed.value;
    // Course files written on Windows separate folders by a backslash.
    let names = [name.clone(), name.replace('\\', "/")];
    let folder = scene_path.parent().unwrap_or(Path::new(""));
    let above = if dialect.conventions().lenient { ABOVE } else { 0 };
    let mut candidates: Vec<PathBuf> = Vec::new();
    let usual = names.iter().flat_map(|name| [folder.join(name), PathBuf::from(name)]);
    let further = folder.ancestors().skip(1).take(above);
    let further = further.flat_map(|folder| names.iter().map(move |name| folder.join(name)));
    for candidate in usual.chain(further) {
        if !candidates.contains(&candidate) {
            candidates.push(candidate);
        }
    }
    ResolvedTexture { name: name.clone(), candidates, span: placed.span }
}

fn check_texture(placed: &Placed<Material>, count: usize, sink: &mut Sink) -> Option<u32> {
    let texture = placed.value.texture?;
    if texture as usize >= count {
        let message = does_not_exist("texture", i64::from(texture), count);
        let error = Diagnostic::error("unknown-texture", message);
        sink.error(error.at(placed.span).label("this material names it"));
        return None;
    }
    Some(texture)
}

fn resolve_material(
    placed: &Placed<Material>,
    texture: Option<u32>,
    conventions: &Conventions,
    sink: &mut Sink,
) -> ResolvedMaterial {
    let Placed { value: material, span } = placed;
    let Material { k_specular, k_transmission, index_of_refraction, .. } = *material;
    for (name, value) in [("ks", k_specular), ("kt", k_transmission)] {
        if value < 0.0 {
            sink.warn("material-range", || {
                let message = format!("{name} is {}: expected 0 or more", General(value));
                Diagnostic::warning("material-range", message).at(*span).label("used as written")
            });
        }
    }
    if k_transmission > 0.0 && index_of_refraction <= 0.0 {
        let ir = General(index_of_refraction);
        let message = format!("the index of refraction is {ir}, but must be above 0 where kt is above 0");
        sink.error(Diagnostic::error("index-of-refraction", message).at(*span).label("of this material"));
    }
    let (procedural, warnings) = parse_clauses(&material.text);
    for message in warnings {
        sink.warn("material-text", || {
            Diagnostic::warning("material-text", message).at(*span).label("in the text of this material")
        });
    }
    let Weights { shininess, reflection, transmission } = material.weights.unwrap_or(Weights {
        shininess: 128.0 * k_specular,
        reflection: k_specular * material.specular,
        transmission: k_transmission * material.specular,
    });
    let transmission = finite(transmission);
    ResolvedMaterial {
        ambient: material.ambient,
        diffuse: material.diffuse,
        specular: material.specular,
        emissive: material.emissive,
        // A negative exponent would make the highlight infinite where the cosine is 0.
        shininess: shininess.clamp(0.0, f64::MAX),
        reflection: finite(reflection),
        transmission,
        shadow: if conventions.see_through_shadows { transmission } else { Vec3::ZERO },
        texture_on_all_light: conventions.texture_on_all_light,
        index_of_refraction,
        texture,
        procedural,
    }
}

/// A product of finite numbers kept from overflowing: infinity times 0 would be no number.
fn finite(color: Vec3) -> Vec3 {
    color.clamp(Vec3::MIN, Vec3::MAX)
}

/// Material -1.
fn default_material() -> ResolvedMaterial {
    let specular = Vec3::splat(0.8);
    ResolvedMaterial {
        ambient: Vec3::splat(0.2),
        diffuse: Vec3::splat(0.8),
        specular,
        emissive: Vec3::ZERO,
        shininess: 128.0,
        reflection: specular,
        transmission: Vec3::ZERO,
        shadow: Vec3::ZERO,
        texture_on_all_light: false,
        index_of_refraction: 1.0,
        texture: None,
        procedural: Procedural::default(),
    }
}

/// Each shape's material number must name a material of its own file, or be -1: one scan over the numbers.
pub fn check_shapes(files: &[SceneFile], sink: &mut Sink) {
    for (number, file) in (0..).map(FileId).zip(files) {
        check_file(number, file, sink);
    }
}

fn check_file(number: FileId, file: &SceneFile, sink: &mut Sink) {
    /// So many are shown for a file: a wrong count tends to spoil many shapes at once.
    const SHOWN: usize = 5;
    let count = file.materials.len();
    let known = -1..i64::try_from(count).unwrap_or(i64::MAX);
    let mut bad_count = 0;
    let mut shown = Vec::new();
    for kind in ShapeKind::ALL {
        let materials = file.shape_materials(kind).iter().enumerate();
        let bad = materials.filter(|(_, material)| !known.contains(&i64::from(**material)));
        for (place, (index, material)) in bad.enumerate() {
            bad_count += 1;
            if place < SHOWN {
                shown.push((file.shape_span(number, kind, index), *material));
            }
        }
    }
    shown.sort_by_key(|(span, _)| *span);
    shown.truncate(SHOWN);
    let shown_count = shown.len();
    for (place, (span, material)) in shown.into_iter().enumerate() {
        let message = does_not_exist("material", i64::from(material), count);
        let error = Diagnostic::error("unknown-material", message);
        let mut error = error.at(span.unwrap_or_default()).label("this shape names it");
        if place + 1 == shown_count && bad_count > shown_count {
            let more = bad_count - shown_count;
            error = error.note(format!("and {more} more shapes of this file name no material"));
        }
        sink.error(error);
    }
}

fn does_not_exist(what: &str, number: i64, count: usize) -> String {
    let has = match count {
        0 => format!("no {what}s"),
        1 => "1 (number 0)".to_owned(),
        _ => format!("{count} (0 to {})", count - 1),
    };
    format!("{what} {number} does not exist: the file has {has}")
}
