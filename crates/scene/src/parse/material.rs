//! `#texture`, `#material`, `#vertex`, `#ray_file`, `#ray_file_instance`.

use super::NOT_LOADED;
use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::model::Include;
use crate::model::Item;
use crate::model::Material;
use crate::model::Placed;
use crate::model::Vertex;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;

/// How many arguments a material of the dialects `uva` and `jhu` has.
const MATERIAL_OF_UVA: usize = 19;

/// How many arguments a vertex has where its colour comes last.
const VERTEX_OF_UNISA: usize = 11;

impl Parser<'_> {
    /// The name or text argument of the directive at hand. Bytes that are no UTF-8 become U+FFFD.
    pub(super) fn word(&self) -> String {
        let inner = self.call.word.map(|token| self.lexer.inner(token)).unwrap_or_default();
        String::from_utf8_lossy(inner).into_owned()
    }

    pub(super) fn texture(&mut self) {
        self.seen.textures += 1;
        let (value, span) = (self.word(), self.call_span());
        self.scene.textures.push(Placed { value, span });
    }

    pub(super) fn material(&mut self) {
        self.seen.materials += 1;
        if self.call.count == MATERIAL_OF_UVA {
            return self.material_of_uva();
        }
        let texture = match self.whole(15) {
            Some(-1) => None,
            Some(number) => match u32::try_from(number) {
                Ok(number) => Some(number),
                Err(_) => return self.unknown(15, "unknown-texture", "texture", "textures"),
            },
            None => return,
        };
        let &[ar, ag, ab, dr, dg, db, sr, sg, sb, er, eg, eb, k_specular, k_transmission, ir, ..] =
            &self.values;
        let ir = match self.conventions.lenient {
            true => self.lenient_index(k_transmission > 0.0, ir, 14),
            false => ir,
        };
        if k_transmission > 0.0 && ir <= 0.0 {
            let message = format!(
                "the material transmits light (kt is {k_transmission}), but its index of refraction is {ir}"
            );
            self.argument_error(14, "index-of-refraction", message, "must be above 0");
            return;
        }
        let value = Material {
            ambient: Vec3::new(ar, ag, ab),
            diffuse: Vec3::new(dr, dg, db),
            specular: Vec3::new(sr, sg, sb),
            emissive: Vec3::new(er, eg, eb),
            k_specular,
            k_transmission,
            index_of_refraction: ir,
            texture,
            bump: None,
            text: self.word(),
            weights: None,
        };
        let span = self.call_span();
        self.scene.materials.push(Placed { value, span });
    }

    pub(super) fn vertex(&mut self) {
        self.seen.vertices += 1;
        let &[px, py, pz, nx, ny, nz, ts, tt, r, g, b, ..] = &self.values;
        if self.call.count == VERTEX_OF_UNISA {
            self.scene.vertex_colors.resize(self.scene.vertices.len(), None);
            self.scene.vertex_colors.push(Some(Vec3::new(r, g, b)));
            if self.seen.colored_vertex.is_none() && [r, g, b] != [1.0; 3] && [r, g, b] != [0.0; 3] {
                self.seen.colored_vertex = Some(self.call_span());
            }
        }
        self.scene.vertices.push(Vertex {
            position: Vec3::new(px, py, pz),
            normal: Vec3::new(nx, ny, nz),
            texcoord: Vec2::new(ts, tt),
        });
    }

    /// At the end of the file: colours that its shader does not show go.
    pub(super) fn finish_vertex_colors(&mut self) {
        let scene = &mut self.scene;
        if self.seen.shows_vertex_colors && !scene.vertex_colors.is_empty() {
            scene.vertex_colors.resize(scene.vertices.len(), None);
            return;
        }
        scene.vertex_colors = Vec::new();
        if let Some(span) = self.seen.colored_vertex {
            self.sink.warn("ignored-part", || {
                let message = "the colours of vertices have no effect: surfaces have those of their material";
                let help = "where the second name of `#shader` is `VertexColour`, they show";
                Diagnostic::warning("ignored-part", message).at(span).help(help)
            });
        }
    }

    pub(super) fn ray_file(&mut self) {
        self.seen.includes += 1;
        let (name, span) = (self.word(), self.call_span());
        self.scene.includes.push(Placed { value: Include { name, file: NOT_LOADED }, span });
    }

    pub(super) fn instance(&mut self) {
        let Some(number) = self.whole(0) else { return };
        match u32::try_from(number) {
            Ok(number) => {
                let span = self.arguments_span(0, 1);
                self.instances.push((number, span));
                self.push_item(Item::Instance(number));
            }
            Err(_) => self.unknown(0, "unknown-include", "included file", "included files"),
        }
    }

    /// An argument that is a number of nothing, whatever the file holds.
    pub(super) fn unknown(&mut self, place: usize, code: &'static str, what: &str, whats: &str) {
        let message = format!("{} names no {what}", self.written(place));
        let span = self.arguments_span(place, 1);
        self.sink
            .error(Diagnostic::error(code, message).at(span).label(format!("{whats} are numbered from 0")));
    }
}
