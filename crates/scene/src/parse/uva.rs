//! What the dialects `uva` and `unisa` have besides.

use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::model::Material;
use crate::model::Placed;
use crate::model::Weights;
use dotray_geometry::Mat4;
use dotray_geometry::Vec3;

impl Parser<'_> {
    /// A material whose weights are colours of their own.
    pub(super) fn material_of_uva(&mut self) {
        let texture = match self.whole(17) {
            Some(-1) => None,
            Some(number) => match u32::try_from(number) {
                Ok(number) => Some(number),
                Err(_) => return self.unknown(17, "unknown-texture", "texture", "textures"),
            },
            None => return,
        };
        let &[er, eg, eb, ar, ag, ab, dr, dg, db, sr, sg, sb, shininess, tr, tg, tb, ir, ..] = &self.values;
        let (specular, transmission) = (Vec3::new(sr, sg, sb), Vec3::new(tr, tg, tb));
        let ir = self.lenient_index(transmission.max_element() > 0.0, ir, 16);
        let value = Material {
            ambient: Vec3::new(ar, ag, ab),
            diffuse: Vec3::new(dr, dg, db),
            specular,
            emissive: Vec3::new(er, eg, eb),
            k_specular: 0.0,
            k_transmission: 0.0,
            index_of_refraction: ir,
            texture,
            bump: None,
            text: self.word(),
            weights: Some(Weights { shininess, reflection: specular, transmission }),
        };
        let span = self.call_span();
        self.scene.materials.push(Placed { value, span });
    }

    pub(super) fn joint_begin(&mut self) {
        self.ignored("`#joint_begin` is read as a group at its rest pose");
        let span = self.call_span();
        // The name stands before the matrix.
        let mut rows = [0.0; 16];
        for (row, value) in rows.iter_mut().zip(self.values.iter().skip(1)) {
            *row = *value;
        }
        let value =
            if self.call.count == 1 { Mat4::IDENTITY } else { Mat4::from_cols_array(&rows).transpose() };
        self.open_group(Placed { value, span });
    }

    pub(super) fn joint_end(&mut self) {
        self.group_end();
    }

    pub(super) fn key_file(&mut self) {
        self.ignored("`#key_file` is not read: the scene stands at its rest pose");
    }

    pub(super) fn shader(&mut self) {
        // The course's own program of this name shows the colours of vertices, and all others those of materials.
        if self.dialect == Dialect::Unisa && self.word().to_ascii_lowercase().contains("vertexcolo") {
            self.seen.shows_vertex_colors = true;
            return;
        }
        self.ignored("`#shader` has no effect: its programs are for a graphics card");
    }

    /// The index of refraction; 1 where light passes and the index is not above 0, as it is in some courses' files.
    pub(super) fn lenient_index(&mut self, transmits: bool, index: f64, place: usize) -> f64 {
        if !transmits || index > 0.0 {
            return index;
        }
        let span = self.arguments_span(place, 1);
        self.sink.warn("ignored-part", || {
            let message = format!("the index of refraction {index} is read as 1: light passes unbent");
            Diagnostic::warning("ignored-part", message).at(span).label("should be above 0")
        });
        1.0
    }

    /// Warns of a part of the file that the picture will not show.
    pub(super) fn ignored(&mut self, message: &str) {
        let span = self.call_span();
        self.sink.warn("ignored-part", || Diagnostic::warning("ignored-part", message).at(span));
    }
}
