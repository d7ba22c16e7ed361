//! Changing numbers in the text of a scene, and nothing else: comments, layout and every other number stay.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use dotray_scene::lex::Lexer;
use dotray_scene::lex::TokenKind;
use dotray_scene::lex::number;
use dotray_scene::model::Camera;
use dotray_scene::model::Light;
use dotray_scene::model::Material;
use dotray_scene::span::Span;
use std::fmt::Write;

/// The arguments that a directive is to have.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The directive.
    pub span: Span,
    /// Its first arguments, in the order of the language.
    pub values: Vec<f64>,
}

/// Why the text cannot be changed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// The text is not what was read.
    #[error(
        "the directive at byte {0} is not there any more: the file has changed; wait until it is read again"
    )]
    Moved(u64),
    /// Two changes of one directive.
    #[error("the directive at byte {0} is to be changed twice")]
    Twice(u64),
}

/// The text with the numbers of these directives in place; a number that is equal already stays as it is written.
///
/// # Errors
/// [`EditError`] where a directive is not found.
pub fn changed(text: &[u8], changes: &[Change]) -> Result<Vec<u8>, EditError> {
    let mut changes: Vec<&Change> = changes.iter().collect();
    changes.sort_by_key(|change| change.span.start);
    let mut out = Vec::with_capacity(text.len() + 64);
    let mut at = 0;
    for change in changes {
        let moved = EditError::Moved(change.span.start);
        if change.span.start < at as u64 {
            return Err(EditError::Twice(change.span.start));
        }
        for (start, end, value) in numbers(text, change).ok_or(moved.clone())? {
            out.extend_from_slice(text.get(at..start).ok_or(moved.clone())?);
            out.extend_from_slice(written(value).as_bytes());
            at = end;
        }
    }
    out.extend_from_slice(text.get(at..).unwrap_or_default());
    Ok(out)
}

/// The places of the numbers that differ, with what is to stand there.
fn numbers(text: &[u8], change: &Change) -> Option<Vec<(usize, usize, f64)>> {
    let mut lexer = Lexer::from(text, usize::try_from(change.span.start).ok()?);
    let head = lexer.token().ok()??;
    if head.kind != TokenKind::Directive || head.start as u64 != change.span.start {
        return None;
    }
    let mut places = Vec::new();
    for &value in &change.values {
        let token = lexer.token().ok()??;
        let old = number(lexer.text(token)).ok()?;
        if token.kind != TokenKind::Word {
            return None;
        }
        if old != value {
            places.push((token.start, token.end, value));
        }
    }
    Some(places)
}

/// The shortest text that gives the number back.
pub fn written(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-5..1e15).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// The number with seven digits: more than a hand at a mouse means.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// The camera with its numbers rounded, as `#camera` lines hold it.
pub fn rounded_camera(camera: &Camera) -> Camera {
    Camera {
        position: camera.position.to_array().map(rounded).into(),
        direction: camera.direction.to_array().map(rounded).into(),
        up: camera.up.to_array().map(rounded).into(),
        half_angle: rounded(camera.half_angle),
    }
}

/// The arguments of `#camera`.
pub fn camera_values(camera: &Camera) -> Vec<f64> {
    let vectors = [camera.position, camera.direction, camera.up];
    vectors.iter().flat_map(|v| v.to_array()).chain([camera.half_angle]).collect()
}

/// A `#camera` line.
pub fn camera_line(camera: &Camera) -> String {
    let mut line = "#camera".to_owned();
    for (index, value) in camera_values(camera).into_iter().enumerate() {
        let gap = if index > 0 && index % 3 == 0 { "  " } else { " " };
        let _ = write!(line, "{gap}{}", written(value));
    }
    line
}

/// The text with this camera: the numbers of its `#camera` changed, or a line put before everything.
///
/// # Errors
/// [`EditError`] where the directive is not found.
pub fn with_camera(text: &[u8], place: Option<Span>, camera: &Camera) -> Result<Vec<u8>, EditError> {
    match place {
        Some(span) => changed(text, &[Change { span, values: camera_values(camera) }]),
        None => {
            let mark: &[u8] = b"\xef\xbb\xbf";
            let (head, rest) = match text.strip_prefix(mark) {
                Some(rest) => (mark, rest),
                None => (&[][..], text),
            };
            Ok([head, camera_line(camera).as_bytes(), b"\n", rest].concat())
        }
    }
}

/// The numbers of `#material`, but for the texture's.
pub fn material_values(material: &Material) -> Vec<f64> {
    let colors = [material.ambient, material.diffuse, material.specular, material.emissive];
    let weights = [material.k_specular, material.k_transmission, material.index_of_refraction];
    colors.iter().flat_map(|color| color.to_array()).chain(weights).collect()
}

/// The numbers of `#light_…`.
pub fn light_values(light: &Light) -> Vec<f64> {
    let fading = |a: &dotray_scene::model::Attenuation| vec![a.constant, a.linear, a.quadratic];
    let vectors = |all: &[dotray_geometry::Vec3]| all.iter().flat_map(|v| v.to_array()).collect::<Vec<f64>>();
    match light {
        Light::Point { color, position, attenuation } => {
            [vectors(&[*color, *position]), fading(attenuation)].concat()
        }
        Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => {
            let cone = vec![*cutoff, *dropoff];
            [vectors(&[*color, *position, *direction]), fading(attenuation), cone].concat()
        }
        Light::Directional { color, direction } => vectors(&[*color, *direction]),
        Light::Area { color, position, direction, radius, attenuation } => {
            [vectors(&[*color, *position, *direction]), vec![*radius], fading(attenuation)].concat()
        }
    }
}
