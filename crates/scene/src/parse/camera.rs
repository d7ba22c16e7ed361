//! `#camera`, `#background`, `#ambient`, lights, and the `#…_num` hints.

use super::Hint;
use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::dialect::Conventions;
use crate::dialect::Dialect;
use crate::model::Attenuation;
use crate::model::Camera;
use crate::model::Light;
use crate::model::Placed;
use crate::model::Tint;
use crate::span::FileId;
use dotray_geometry::Vec3;
use std::f64::consts::FRAC_PI_2;
use std::f64::consts::PI;

/// How many arguments lights of one colour have.
const POINT: usize = 9;
const SPOT: usize = 14;
const DIRECTIONAL: usize = 6;

impl Parser<'_> {
    /// Camera, lights and colours of an included file do not count, so what is wrong with their values does
    /// not, either.
    fn view_counts(&self) -> bool {
        self.file == FileId(0)
    }

    fn view_error(&mut self, diagnostic: Diagnostic) {
        if self.view_counts() {
            self.sink.error(diagnostic);
        }
    }

    fn view_warning(&mut self, code: &'static str, make: impl FnOnce() -> Diagnostic) {
        if self.view_counts() {
            self.sink.warn(code, make);
        }
    }

    fn vector(&self, first: usize) -> Vec3 {
        Vec3::new(self.value(first), self.value(first + 1), self.value(first + 2))
    }

    /// A vector that has a direction: not 0, and neither so short nor so long that its length is lost.
    fn direction_at(&mut self, first: usize, what: &str) -> Option<Vec3> {
        let vector = self.vector(first);
        let square = vector.length_squared();
        if square.is_finite() && square >= f64::MIN_POSITIVE {
            return Some(vector);
        }
        let (fault, label) = if vector == Vec3::ZERO {
            ("has length 0", "points nowhere")
        } else {
            ("has a length that double precision cannot hold", "give it a length near 1")
        };
        let message = format!("the {what} of `{}` {fault}", self.call.spec.word);
        let span = self.arguments_span(first, 3);
        self.view_error(Diagnostic::error("zero-direction", message).at(span).label(label));
        None
    }

    pub(super) fn camera(&mut self) {
        // Files that are only to be included have such a line in some courses.
        if self.conventions.lenient && (0..10).all(|place| self.value(place) == 0.0) {
            return;
        }
        let direction = self.direction_at(3, "view direction");
        let up = self.direction_at(6, "up vector");
        let angle = self.value(9);
        let half_angle = angle * self.conventions.half_angle;
        let angle_fits =
            0.0 < half_angle && half_angle < FRAC_PI_2 && angle < self.conventions.most_camera_angle;
        if !angle_fits {
            self.wrong_half_angle(angle);
        }
        let (Some(direction), Some(up)) = (direction, up) else { return };
        // The sine of the angle between them; below this the picture's right side is rounding noise.
        if direction.normalize().cross(up.normalize()).length() <= 1e-12 {
            let span = self.arguments_span(6, 3);
            let error =
                Diagnostic::error("parallel-up", "the camera's up vector is parallel to its view direction");
            self.view_error(error.at(span).label("does not say which side of the picture is up"));
            return;
        }
        if angle_fits {
            let value = Camera { position: self.vector(0), direction, up, half_angle };
            let first = self.scene.camera.map(|camera| camera.span);
            self.first_counts(first, |parser, span| parser.scene.camera = Some(Placed { value, span }));
        }
    }

    fn wrong_half_angle(&mut self, half_angle: f64) {
        if self.dialect != Dialect::Slides {
            let Conventions { camera_angle, most_camera_angle, .. } = *self.conventions;
            let most = if most_camera_angle > 10.0 { "90 degrees" } else { "π" };
            let message =
                format!("the camera's {camera_angle} {half_angle} does not lie between 0 and {most}");
            let error = Diagnostic::error("half-angle", message).at(self.arguments_span(9, 1));
            let dialect = self.dialect;
            self.view_error(error.label(format!("as the dialect `{dialect}` has it")));
            return;
        }
        let message = format!("the camera's half angle {half_angle} does not lie between 0 and π/2");
        let span = self.arguments_span(9, 1);
        let error = Diagnostic::error("half-angle", message).at(span);
        self.view_error(if half_angle >= FRAC_PI_2 {
            let radians = half_angle * PI / 180.0;
            error.label("looks like degrees").help(format!(
                "the angle is half of the vertical view angle, in radians: {half_angle} degrees are {radians:.4}"
            ))
        } else {
            error.label("must be above 0")
        });
    }

    pub(super) fn background(&mut self) {
        let value = self.vector(0);
        let first = self.scene.background.map(|color| color.span);
        self.first_counts(first, |parser, span| parser.scene.background = Some(Placed { value, span }));
    }

    pub(super) fn ambient(&mut self) {
        let value = self.vector(0);
        let first = self.scene.ambient.map(|color| color.span);
        self.first_counts(first, |parser, span| parser.scene.ambient = Some(Placed { value, span }));
    }

    fn first_counts(
        &mut self,
        first: Option<crate::span::Span>,
        set: impl FnOnce(&mut Self, crate::span::Span),
    ) {
        let span = self.call_span();
        let Some(first) = first else { return set(self, span) };
        let word = self.call.spec.word;
        self.view_warning("repeated-directive", || {
            Diagnostic::warning("repeated-directive", format!("a second `{word}` has no effect"))
                .at(span)
                .label("is not used")
                .note_at(first, "the first one counts")
        });
    }

    fn attenuation(&mut self, first: usize) -> Attenuation {
        let Vec3 { x: constant, y: linear, z: quadratic } = self.vector(first);
        let fault = if constant < 0.0 || linear < 0.0 || quadratic < 0.0 {
            Some("an attenuation coefficient is below 0")
        } else if constant == 0.0 && linear == 0.0 && quadratic == 0.0 {
            Some("all attenuation coefficients are 0")
        } else {
            None
        };
        if let Some(fault) = fault {
            let (bytes, call, first) = (self.bytes, self.call_span(), self.token_of(first));
            self.view_warning("attenuation", || {
                Diagnostic::warning("attenuation", fault)
                    .at(super::arguments::arguments_span(bytes, call, first, 3))
                    .label("where their sum is not above 0, the light does not fade")
                    .help("`1 0 0` is a light that does not fade")
            });
        }
        Attenuation { constant, linear, quadratic }
    }

    /// The light's colour, and the place of the argument after it. `plain` is the number of arguments of a light with
    /// one colour; six more stand for its colours by kind of reflection.
    fn light_color(&mut self, plain: usize) -> (Vec3, usize) {
        if self.call.count == plain {
            return (self.vector(0), 3);
        }
        let [ambient, diffuse, specular] = [0, 3, 6].map(|place| self.vector(place));
        let color = ambient.max(diffuse).max(specular);
        let part = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        let parts = |v: Vec3| Vec3::new(part(v.x, color.x), part(v.y, color.y), part(v.z, color.z));
        self.scene.tints.resize(self.scene.lights.len(), Tint::PLAIN);
        self.scene.tints.push(Tint {
            ambient: parts(ambient),
            diffuse: parts(diffuse),
            specular: parts(specular),
        });
        (color, 9)
    }

    fn push_light(&mut self, value: Light) {
        let span = self.call_span();
        self.scene.lights.push(Placed { value, span });
    }

    pub(super) fn light_point(&mut self) {
        self.seen.lights += 1;
        let (color, at) = self.light_color(POINT);
        let attenuation = self.attenuation(at + 3);
        self.push_light(Light::Point { color, position: self.vector(at), attenuation });
    }

    pub(super) fn light_spot(&mut self) {
        self.seen.lights += 1;
        let (color, at) = self.light_color(SPOT);
        let direction = self.direction_at(at + 3, "axis");
        let attenuation = self.attenuation(at + 6);
        let cutoff = self.value(at + 9) * self.conventions.spot_angle;
        // Dividing by a power of two rounds nothing.
        let dropoff = self.value(at + 10) * (self.conventions.dropoff / 128.0);
        if !(0.0..=PI).contains(&cutoff) {
            self.odd_cutoff(at + 9);
        }
        if let Some(direction) = direction {
            let position = self.vector(at);
            self.push_light(Light::Spot { color, position, direction, attenuation, cutoff, dropoff });
        }
    }

    fn odd_cutoff(&mut self, place: usize) {
        let (bytes, call, token, cutoff) =
            (self.bytes, self.call_span(), self.token_of(place), self.value(place));
        let degrees = self.conventions.spot_angle != 1.0;
        self.view_warning("spot-angle", || {
            let most = if degrees { "180 degrees" } else { "π" };
            let message = format!("the spot's cut-off angle {cutoff} does not lie between 0 and {most}");
            let span = super::arguments::arguments_span(bytes, call, token, 1);
            let warning = Diagnostic::warning("spot-angle", message).at(span);
            if cutoff > 0.0 && degrees {
                warning.label("the lamp shines to all sides")
            } else if cutoff > 0.0 {
                let radians = cutoff * PI / 180.0;
                let help = format!("the angle is in radians: {cutoff} degrees are {radians:.4}");
                warning.label("looks like degrees").help(help)
            } else {
                warning.label("the lamp lights nothing")
            }
        });
    }

    pub(super) fn light_directional(&mut self) {
        self.seen.lights += 1;
        let (color, at) = self.light_color(DIRECTIONAL);
        if let Some(direction) = self.direction_at(at, "direction") {
            self.push_light(Light::Directional { color, direction });
        }
    }

    pub(super) fn light_area(&mut self) {
        self.seen.lights += 1;
        let direction = self.direction_at(6, "normal");
        let radius = self.value(9);
        let attenuation = self.attenuation(10);
        if radius <= 0.0 {
            let message = format!("the lamp's radius {radius} is not above 0");
            let span = self.arguments_span(9, 1);
            self.view_error(Diagnostic::error("lamp-radius", message).at(span).label("must be above 0"));
            return;
        }
        if let Some(direction) = direction {
            let (color, position) = (self.vector(0), self.vector(3));
            self.push_light(Light::Area { color, position, direction, radius, attenuation });
        }
    }

    pub(super) fn hint(&mut self) {
        let (count, directive, span) = (self.value(0), self.call.spec.directive, self.call_span());
        match self.whole(0) {
            Some(whole) if whole < 0 => {
                let message = format!("the number of `{}` is below 0", self.call.spec.word);
                self.argument_error(0, "negative-count", message, "must be 0 or more");
            }
            Some(_) => self.hints.push(Hint { directive, count, span }),
            None => {}
        }
    }
}
