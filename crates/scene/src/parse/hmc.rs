//! The dialect `hmc`: flags, names, and shapes along z.

use super::Parser;
use super::arguments;
use super::bumps::BumpFile;
use super::bumps::BumpFiles;
use crate::diagnostic::Diagnostic;
use crate::directive::Directive;
use crate::directive::Spec;
use crate::lex;
use crate::lex::TokenKind;
use crate::model::Item;
use crate::model::Material;
use crate::model::Placed;
use crate::model::ShapeKind;
use crate::model::ShapeList;
use crate::model::Weights;
use crate::span::Span;
use dotray_geometry::Cone;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat3;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::ShapeError;
use dotray_geometry::Torus;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// A name as written.
type Name = Vec<u8>;

/// Which texture a shape shows.
#[derive(Clone, PartialEq, Eq, Hash)]
enum Shown {
    /// None: the shape has no `-t`.
    Nothing,
    /// Its material's.
    Own,
    /// That of a file.
    File(Name),
}

/// What shapes use of a material: a texture, and how far its bump image leans their normals.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Use {
    name: Name,
    shown: Shown,
    /// The bits of the shape's `-u`; those of 0 without.
    bump_scale: u64,
}

/// The flags of the directive at hand, and the names that the file has used and given so far.
#[derive(Default)]
pub(super) struct Named {
    /// How many tokens the flags are, their end included.
    pub flag_tokens: i32,
    name: Option<Name>,
    material: Option<Name>,
    texture: Option<Option<Name>>,
    pub bump: Option<Option<Name>>,
    closed: bool,
    uses: Vec<(Use, Span)>,
    use_of: HashMap<Use, i32>,
    materials: HashMap<Name, usize>,
    /// The bump images of materials, by the materials' numbers.
    pub bumps: BumpFiles,
    textures: HashMap<Name, u32>,
    /// What the directives outside all groups say.
    root: Option<Mat4>,
}

/// Takes y to z, z to -y: cylinders, cones and tori stand along z here.
const Z_FROM_Y: Mat3 = Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y);

/// Object coordinates of a point, before [`Z_FROM_Y`].
fn before_turn(point: Vec3) -> Vec3 {
    Vec3::new(point.x, point.z, -point.y)
}

/// The directives that name a material.
const SHAPES: [Directive; 6] = [
    Directive::ShapeSphere,
    Directive::ShapeBox,
    Directive::ShapeCylinder,
    Directive::ShapeCone,
    Directive::ShapeTorus,
    Directive::ShapeTriangle,
];

impl Parser<'_> {
    /// Reads `-x value … --` if it comes; false where it is not closed.
    pub(super) fn flags(&mut self, spec: &'static Spec, start: usize) -> bool {
        let named = &mut self.named;
        (named.flag_tokens, named.closed) = (0, false);
        (named.name, named.material, named.texture, named.bump) = (None, None, None, None);
        let mut flag = None;
        loop {
            let before = self.lexer.at();
            let token = match self.lexer.token() {
                Ok(Some(token)) => token,
                Ok(None) => return self.flags_end(spec, start, flag.is_none()),
                Err(fault) => {
                    self.unterminated(fault);
                    return false;
                }
            };
            let text = self.lexer.text(token);
            let is_flag = token.kind == TokenKind::Word && text.len() > 1 && text.first() == Some(&b'-');
            let is_flag =
                is_flag && text.get(1).is_some_and(|sign| sign.is_ascii_alphabetic() || *sign == b'-');
            let ends = token.kind == TokenKind::Directive
                || (!is_flag && flag.is_none())
                || (lex::number(text).is_ok() && !self.takes_value(flag));
            if ends {
                self.lexer.go_to(before);
                return self.flags_end(spec, start, flag.is_none());
            }
            self.named.flag_tokens += 1;
            if text == b"--" {
                self.call.end = token.end;
                return true;
            }
            let value = self.lexer.inner(token).to_vec();
            match (is_flag, flag) {
                (true, _) => {
                    flag = text.get(1).copied();
                    let span = self.span(token.start, token.end);
                    self.flag(spec, flag.unwrap_or_default(), span);
                }
                (false, Some(b'n')) => self.named.name = Some(value),
                (false, Some(b'm')) => self.named.material = Some(value),
                (false, Some(b't')) => self.named.texture = Some(Some(value)),
                (false, Some(b'u')) => self.named.bump = Some(Some(value)),
                (false, _) => {}
            }
        }
    }

    /// Whether a flag still waits for its value.
    fn takes_value(&self, flag: Option<u8>) -> bool {
        match flag {
            Some(b'n') => self.named.name.is_none(),
            Some(b'm') => self.named.material.is_none(),
            Some(b't') => self.named.texture == Some(None),
            Some(b'u') => self.named.bump == Some(None),
            Some(b'c') | None => false,
            Some(_) => true,
        }
    }

    fn flag(&mut self, spec: &'static Spec, flag: u8, span: Span) {
        match flag {
            b'n' | b'm' => {}
            b'c' => self.named.closed = true,
            b't' => self.named.texture = Some(None),
            b'u' if spec.directive == Directive::Material || SHAPES.contains(&spec.directive) => {
                self.named.bump = Some(None);
            }
            _other => {
                let word = spec.word;
                self.sink.warn("ignored-part", || {
                    let what = match flag {
                        b'p' => "noise textures are not supported",
                        _other => "this flag is not known",
                    };
                    let message = format!("`-{}` of `{word}` has no effect: {what}", char::from(flag));
                    Diagnostic::warning("ignored-part", message).at(span)
                });
            }
        }
    }

    fn flags_end(&mut self, spec: &'static Spec, start: usize, none: bool) -> bool {
        if !none {
            let word = spec.word;
            let message = format!("the flags of `{word}` do not end");
            let span = self.span(start, start + word.len());
            let error = Diagnostic::error("unclosed-flags", message).at(span);
            self.sink
                .error(error.label("`--` is missing").help("flags stand between the directive and `--`"));
            self.skip_arguments();
        }
        none
    }

    pub(super) fn apply_hmc(&mut self) {
        self.call.skip = self.named.flag_tokens;
        let directive = self.call.spec.directive;
        if directive == Directive::Material {
            self.named_material();
        } else if SHAPES.contains(&directive) {
            self.with_material(directive);
        } else {
            self.apply_directive();
        }
    }

    /// Puts the number of the material's name before the shape's own values.
    fn with_material(&mut self, directive: Directive) {
        let number = match self.named.material.clone() {
            None => -1,
            Some(name) => {
                let shown = match self.named.texture.clone() {
                    None => Shown::Nothing,
                    Some(None) => Shown::Own,
                    Some(Some(file)) => Shown::File(file),
                };
                let bump_scale = self.bump_scale().to_bits();
                self.use_material(Use { name, shown, bump_scale })
            }
        };
        self.take_material(number);
        self.call.skip -= 1;
        if directive == Directive::ShapeCylinder {
            self.cylinder_along_z();
        } else if directive == Directive::ShapeCone {
            self.cone_along_z();
        } else if directive == Directive::ShapeTorus {
            self.torus_along_z();
        } else if directive == Directive::ShapeTriangle {
            self.flat_triangle();
        } else {
            self.apply_directive();
        }
    }

    fn use_material(&mut self, used: Use) -> i32 {
        if let Some(number) = self.named.use_of.get(&used) {
            return *number;
        }
        // A file of at most 2^32 bytes has fewer uses than that.
        let number = self.named.uses.len() as i32;
        let span = self.call_span();
        self.named.uses.push((used.clone(), span));
        self.named.use_of.insert(used, number);
        number
    }

    /// The shape at hand in a group of its own, whose y axis is the world's z axis.
    fn turned(&mut self, shape: impl FnOnce(&mut Self)) {
        let span = self.call_span();
        self.open_group(Placed { value: Mat4::from_mat3(Z_FROM_Y), span });
        let before = self.scene.items.len();
        shape(self);
        self.group_end();
        // A shape that was left out needs no group.
        if self.scene.items.len() == before + 1 {
            self.scene.items.truncate(before - 1);
            self.scene.groups.pop();
        }
    }

    fn cylinder_along_z(&mut self) {
        let &[_, px, py, pz, radius, height, ..] = &self.values;
        let center = before_turn(Vec3::new(px, py, pz + 0.5 * height));
        let shape = Cylinder::new(center, radius, height);
        self.turned(|parser| match parser.named.closed {
            true => parser.shape(shape, ShapeKind::Cylinder, |scene| &mut scene.cylinders),
            false => {
                parser.shape(shape.map(OpenSide::Cylinder), ShapeKind::Open, |scene| &mut scene.open_sides);
            }
        });
    }

    fn cone_along_z(&mut self) {
        let &[_, px, py, pz, radius, height, ..] = &self.values;
        let center = before_turn(Vec3::new(px, py, pz + 0.5 * height));
        let shape = Cone::new(center, radius, height);
        self.turned(|parser| match parser.named.closed {
            true => parser.shape(shape, ShapeKind::Cone, |scene| &mut scene.cones),
            false => parser.shape(shape.map(OpenSide::Cone), ShapeKind::Open, |scene| &mut scene.open_sides),
        });
    }

    fn torus_along_z(&mut self) {
        let &[_, px, py, pz, major, minor, ..] = &self.values;
        let shape = Torus::new(before_turn(Vec3::new(px, py, pz)), minor, major);
        self.turned(|parser| parser.shape(shape, ShapeKind::Torus, |scene| &mut scene.tori));
    }

    fn flat_triangle(&mut self) {
        let &[_, ax, ay, az, bx, by, bz, cx, cy, cz, sa, ta, sb, tb, sc, tc, ..] = &self.values;
        let points = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let given = [Vec2::new(sa, ta), Vec2::new(sb, tb), Vec2::new(sc, tc)];
        let texcoords = if self.call.count > 9 { given } else { [Vec2::ZERO; 3] };
        let shape: Result<Triangle, ShapeError> = Triangle::new(points, [Vec3::ZERO; 3], texcoords);
        self.shape(shape, ShapeKind::Triangle, |scene| &mut scene.triangles);
    }

    fn named_material(&mut self) {
        let &[ar, ag, ab, dr, dg, db, sr, sg, sb, er, eg, eb, k_specular, k_transmission, ir, ..] =
            &self.values;
        let ir = self.lenient_index(k_transmission > 0.0, ir, 14);
        let texture = match self.named.texture.clone() {
            Some(Some(file)) => Some(self.texture_number(file, self.call_span())),
            Some(None) | None => None,
        };
        let name = self.named.name.clone().unwrap_or_default();
        let span = self.call_span();
        let number = self.scene.materials.len();
        if let Some(first) = self.named.materials.get(&name).copied() {
            let first = self.scene.materials.get(first).map(|material| material.span).unwrap_or_default();
            let shown = arguments::shown(&name);
            self.sink.warn("repeated-name", || {
                let warning = Diagnostic::warning("repeated-name", format!("a second material {shown}"));
                warning.at(span).label("takes its place").note_at(first, "this one is not used")
            });
        }
        self.named.materials.insert(name, number);
        let specular = Vec3::new(sr, sg, sb);
        let shine = k_specular.clamp(0.0, 1.0);
        let weights = Weights {
            shininess: 128.0 * shine,
            reflection: specular,
            transmission: k_transmission * specular,
        };
        let value = Material {
            ambient: Vec3::new(ar, ag, ab),
            diffuse: Vec3::new(dr, dg, db),
            specular,
            emissive: Vec3::new(er, eg, eb),
            k_specular: shine,
            k_transmission,
            index_of_refraction: ir,
            texture,
            bump: None,
            text: String::new(),
            weights: Some(weights),
        };
        self.scene.materials.push(Placed { value, span });
        if let Some(Some(file)) = self.named.bump.take() {
            self.named.bumps.insert(number, BumpFile::new(file));
        }
    }

    /// A faulty material has its name all the same, or each shape that uses it would be a fault of its own.
    pub(super) fn faulty_name(&mut self) {
        if let Some(name) = self.named.name.take() {
            self.named.materials.entry(name).or_insert(usize::MAX);
        }
    }

    pub(super) fn texture_number(&mut self, file: Name, span: Span) -> u32 {
        if let Some(number) = self.named.textures.get(&file) {
            return *number;
        }
        let number = self.scene.textures.len() as u32;
        let value = String::from_utf8_lossy(&file).into_owned();
        self.scene.textures.push(Placed { value, span });
        self.named.textures.insert(file, number);
        number
    }

    pub(super) fn translate(&mut self) {
        let &[x, y, z, ..] = &self.values;
        self.transform(Mat4::from_translation(Vec3::new(x, y, z)));
    }

    pub(super) fn scale(&mut self) {
        let &[x, y, z, ..] = &self.values;
        self.transform(Mat4::from_scale(Vec3::new(x, y, z)));
    }

    pub(super) fn rotate(&mut self) {
        let &[degrees, x, y, z, ..] = &self.values;
        let axis = Vec3::new(x, y, z).normalize_or_zero();
        if axis == Vec3::ZERO {
            let span = self.arguments_span(1, 3);
            let error = Diagnostic::error("zero-direction", "the axis of `#rotate` has length 0");
            self.sink.error(error.at(span).label("points nowhere"));
            return;
        }
        self.transform(Mat4::from_mat3(rotation(axis, degrees * (PI / 180.0))));
    }

    /// Multiplies the matrix of the group around on the right.
    fn transform(&mut self, matrix: Mat4) {
        match self.open.last().and_then(|number| self.scene.groups.get_mut(*number as usize)) {
            Some(group) => group.value *= matrix,
            None => self.named.root = Some(self.named.root.unwrap_or(Mat4::IDENTITY) * matrix),
        }
    }

    /// At the end of the file: names become numbers.
    pub(super) fn finish_names(&mut self) {
        if let Some(value) = self.named.root.take() {
            let number = self.scene.groups.len() as u32;
            self.scene.groups.push(Placed { value, span: Span::new(self.file, 0, 0) });
            self.scene.items.insert(0, Item::Open(number));
            self.scene.items.push(Item::Close);
        }
        if self.named.uses.is_empty() {
            return;
        }
        let uses = std::mem::take(&mut self.named.uses);
        let materials = std::mem::take(&mut self.named.materials);
        let scales = uses
            .iter()
            .filter_map(|(used, _)| Some((*materials.get(&used.name)?, f64::from_bits(used.bump_scale))));
        self.settle_bumps(scales);
        self.named.materials = materials;
        let numbers: Vec<i32> =
            uses.into_iter().map(|(used, span)| self.material_of_use(used, span)).collect();
        self.order_textures();
        let scene = &mut self.scene;
        renumber(&mut scene.spheres, &numbers);
        renumber(&mut scene.cuboids, &numbers);
        renumber(&mut scene.cylinders, &numbers);
        renumber(&mut scene.cones, &numbers);
        renumber(&mut scene.triangles, &numbers);
        renumber(&mut scene.tori, &numbers);
        renumber(&mut scene.open_sides, &numbers);
        self.seen.materials = self.scene.materials.len();
        self.seen.textures = self.scene.textures.len();
    }

    fn material_of_use(&mut self, used: Use, span: Span) -> i32 {
        let Use { name, shown, bump_scale } = used;
        let Some(number) = self.named.materials.get(&name).copied() else {
            let message = format!("no material has the name {}", arguments::shown(&name));
            self.sink.error(Diagnostic::error("unknown-material", message).at(span));
            return -1;
        };
        let Some(material) = self.scene.materials.get(number).cloned() else { return -1 };
        let texture = match shown {
            Shown::Nothing => None,
            Shown::Own => material.value.texture,
            Shown::File(file) => Some(self.texture_number(file, span)),
        };
        let bump = self.bump_of_use(number, f64::from_bits(bump_scale), span);
        if (texture, bump) == (material.value.texture, material.value.bump) {
            return number as i32;
        }
        let value = Material { texture, bump, ..material.value };
        self.scene.materials.push(Placed { value, span: material.span });
        self.scene.materials.len() as i32 - 1
    }
}

fn renumber<T>(list: &mut ShapeList<T>, numbers: &[i32]) {
    for material in &mut list.materials {
        let number = usize::try_from(*material).ok().and_then(|used| numbers.get(used));
        *material = number.copied().unwrap_or(-1);
    }
}

/// Turns about a unit axis, counter-clockwise seen against it.
fn rotation(axis: Vec3, angle: f64) -> Mat3 {
    let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
    let turned = |v: Vec3| v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine));
    Mat3::from_cols(turned(Vec3::X), turned(Vec3::Y), turned(Vec3::Z))
}
