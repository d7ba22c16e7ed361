//! What the words of an option stand for in the library.

use dotray::accel::Kind;
use dotray::accel::Quality;
use dotray::image::Format;
use dotray::image::compare::profile::Profile;
use dotray::render::Shadows;
use dotray::render::TextureFilter;
use std::path::Path;
use std::path::PathBuf;

use crate::values::Accel;
use crate::values::Build;
use crate::values::Filter;
use crate::values::FormatName;
use crate::values::ProfileName;
use crate::values::ShadowMode;

/// A file, or the standard stream that `-` stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Standard input or output.
    Standard,
    /// A file.
    File(PathBuf),
}

impl Place {
    /// What a typed path means.
    pub fn of(path: &Path) -> Self {
        if path == Path::new("-") { Self::Standard } else { Self::File(path.to_owned()) }
    }
}

/// The format of a name.
pub fn named(name: FormatName) -> Format {
    match name {
        FormatName::Bmp => Format::Bmp,
        FormatName::Png => Format::Png,
        FormatName::Png16 => Format::Png16,
        FormatName::Jpeg => Format::Jpeg,
        FormatName::Ppm => Format::Ppm,
        FormatName::Qoi => Format::Qoi,
        FormatName::Tiff => Format::Tiff,
        FormatName::Exr => Format::Exr,
        FormatName::Hdr => Format::Hdr,
        FormatName::Pfm => Format::Pfm,
    }
}

/// The profile of a word.
pub fn profile(typed: ProfileName) -> Profile {
    match typed {
        ProfileName::Exact => Profile::Exact,
        ProfileName::Strict => Profile::Strict,
        ProfileName::Lenient => Profile::Lenient,
    }
}

/// The structure of a word.
pub fn accel(typed: Accel) -> Kind {
    match typed {
        Accel::Brute => Kind::Brute,
        Accel::Boxes => Kind::Boxes,
        Accel::Octree => Kind::Octree,
        Accel::Bsp => Kind::Bsp,
        Accel::Bvh => Kind::Bvh,
    }
}

/// The effort of a word.
pub fn quality(typed: Build) -> Quality {
    match typed {
        Build::Fast => Quality::Fast,
        Build::Balanced => Quality::Balanced,
        Build::Best => Quality::Best,
    }
}

/// The mode of a word.
pub fn shadows(typed: ShadowMode) -> Shadows {
    match typed {
        ShadowMode::Filtered => Shadows::Filtered,
        ShadowMode::Opaque => Shadows::Opaque,
        ShadowMode::Off => Shadows::Off,
    }
}

/// The filter of a word.
pub fn texture_filter(typed: Filter) -> TextureFilter {
    match typed {
        Filter::Bilinear => TextureFilter::Bilinear,
        Filter::Nearest => TextureFilter::Nearest,
    }
}
