//! Meanings into another dialect's words.

use crate::diagnostic::Diagnostic;
use crate::dialect::Conventions;
use crate::dialect::Dialect;
use crate::model::Color;
use crate::model::Item;
use crate::model::Light;
use crate::model::Material;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::ShapeList;
use crate::model::Tint;
use crate::model::Vertex;
use crate::model::Weights;
use crate::span::FileId;
use crate::span::Span;
use dotray_geometry::Cone;
use dotray_geometry::OpenSide;
use dotray_geometry::Vec3;

/// Collects what is lost.
pub(super) type Lost = Vec<Diagnostic>;

/// A material as it is carried into a dialect.
#[derive(Clone, Copy)]
pub(super) struct Use {
    pub to: Dialect,
    pub span: Span,
}

pub(super) fn lose(lost: &mut Lost, span: Option<Span>, message: impl Into<String>) {
    let warning = Diagnostic::warning("not-carried", message);
    lost.push(Diagnostic { span, ..warning });
}

/// The same scene in the words of `to`.
pub fn carry(written: &[SceneFile], mut file: SceneFile, to: Dialect, lost: &mut Lost) -> SceneFile {
    let (from, into) = (file.dialect.conventions(), to.conventions());
    view(&file, from, into, lost);
    shapes(written, to, lost);
    let has_solids =
        |material: &Material| !crate::procedural::parse_clauses(&material.text).0.solids.is_empty();
    let mut transmits = None;
    for Placed { value, span } in &mut file.materials {
        let weights = weights_of(value);
        if weights.transmission != Vec3::ZERO {
            transmits = transmits.or(Some(*span));
        }
        let colored = value.texture.is_some() || has_solids(value);
        let all_light = value.specular != Vec3::ZERO || value.emissive != Vec3::ZERO;
        if colored && all_light && from.texture_on_all_light != into.texture_on_all_light {
            let whole =
                if into.texture_on_all_light { "highlights and emission, too" } else { "matte light only" };
            lose(lost, Some(*span), format!("the material's texture now colours {whole}"));
        }
        material(value, weights, Use { to, span: *span }, lost);
    }
    if from.see_through_shadows != into.see_through_shadows && transmits.is_some() {
        let how = if into.see_through_shadows { "let light pass" } else { "block light" };
        lose(lost, transmits, format!("see-through surfaces now {how} on its way from the lights"));
    }
    file.lights = lights(&mut file, to, lost);
    if to != Dialect::Unisa {
        super::colors::spell_out_vertex_colors(&mut file, to, lost);
    }
    if to != Dialect::Hmc {
        super::bumps::drop_bumps(&mut file, to, lost);
    }
    if !into.default_material {
        write_default_material(&mut file);
    }
    if !has_open_sides(to) {
        close_open_sides(&mut file);
    }
    if !has_tori(to) {
        drop_runs(&mut file.items, ShapeKind::Torus);
        file.tori = ShapeList::default();
    }
    if !has_truncated_cones(to) {
        for cone in &mut file.cones.shapes {
            *cone = pointed(cone);
        }
        for side in &mut file.open_sides.shapes {
            if let OpenSide::Cone(cone) = side {
                *cone = pointed(cone);
            }
        }
    }
    match to {
        Dialect::Slides => {}
        Dialect::Uva | Dialect::Jhu | Dialect::Unisa => share_vertices(&mut file),
        Dialect::Hmc => super::hmc::flatten_triangles(&mut file, lost),
    }
    file.dialect = to;
    file
}

fn view(file: &SceneFile, from: &Conventions, into: &Conventions, lost: &mut Lost) {
    let Some(Placed { value, span }) = file.background else { return };
    let mirrors = |material: &Material| {
        let Weights { reflection, transmission, .. } = weights_of(material);
        reflection != Vec3::ZERO || transmission != Vec3::ZERO
    };
    let seen = value != Vec3::ZERO && file.materials.iter().any(|placed| mirrors(&placed.value));
    if seen && from.background_behind_surfaces != into.background_behind_surfaces {
        let how = if into.background_behind_surfaces { "now" } else { "no longer" };
        lose(lost, Some(span), format!("mirrors and glass {how} show the background"));
    }
}

fn has_tori(dialect: Dialect) -> bool {
    match dialect {
        Dialect::Jhu | Dialect::Hmc => true,
        Dialect::Slides | Dialect::Uva | Dialect::Unisa => false,
    }
}

fn has_truncated_cones(dialect: Dialect) -> bool {
    match dialect {
        Dialect::Slides => true,
        Dialect::Uva | Dialect::Jhu | Dialect::Hmc | Dialect::Unisa => false,
    }
}

fn has_open_sides(dialect: Dialect) -> bool {
    match dialect {
        Dialect::Slides | Dialect::Hmc => true,
        Dialect::Uva | Dialect::Jhu | Dialect::Unisa => false,
    }
}

/// The cone of the same base and height with an apex.
fn pointed(cone: &Cone) -> Cone {
    Cone::new(cone.center(), cone.radius(), cone.height()).unwrap_or(*cone)
}

fn shapes(written: &[SceneFile], to: Dialect, lost: &mut Lost) {
    for (number, file) in (0..).map(FileId).zip(written) {
        if !has_tori(to) {
            for index in 0..file.tori.shapes.len() {
                let span = file.shape_span(number, ShapeKind::Torus, index);
                lose(lost, span, format!("`{to}` has no torus: it is left out"));
            }
        }
        let cones = file.cones.shapes.iter().enumerate();
        for (index, _) in cones.filter(|(_, cone)| cone.top() > 0.0 && !has_truncated_cones(to)) {
            let span = file.shape_span(number, ShapeKind::Cone, index);
            lose(lost, span, format!("`{to}` has no truncated cone: it goes on to an apex"));
        }
        for (index, side) in file.open_sides.shapes.iter().enumerate() {
            let span = file.shape_span(number, ShapeKind::Open, index);
            let blunt = matches!(side, OpenSide::Cone(cone) if cone.top() > 0.0);
            if blunt && !has_truncated_cones(to) {
                lose(lost, span, format!("`{to}` has no truncated cone: it goes on to an apex"));
            }
            if !has_open_sides(to) {
                lose(lost, span, format!("`{to}` has closed shapes only: it is closed by discs"));
            }
        }
    }
}

/// The weights that the renderer will use.
fn weights_of(material: &Material) -> Weights {
    material.weights.unwrap_or(Weights {
        shininess: 128.0 * material.k_specular,
        reflection: material.k_specular * material.specular,
        transmission: material.k_transmission * material.specular,
    })
}

/// Whether two colours are the same but for rounding.
pub(super) fn same(a: Color, b: Color) -> bool {
    (a - b).abs().max_element() <= 1e-12 * a.abs().max(b.abs()).max_element()
}

fn material(material: &mut Material, weights: Weights, at: Use, lost: &mut Lost) {
    let Use { to, span } = at;
    match to {
        Dialect::Slides | Dialect::Unisa => {
            if material.weights.is_some() {
                to_coefficients(material, weights, span, lost);
            }
            material.weights = None;
        }
        Dialect::Hmc => super::hmc::material(material, weights, at, lost),
        Dialect::Uva | Dialect::Jhu => with_weights(material, weights, at, lost),
    }
}

fn with_weights(material: &mut Material, weights: Weights, Use { to, span }: Use, lost: &mut Lost) {
    if !same(weights.reflection, material.specular) {
        let message =
            format!("the mirror's weight becomes that of the highlight, which is all that `{to}` has");
        lose(lost, Some(span), message);
    }
    if material.text.contains(char::is_whitespace) {
        lose(
            lost,
            Some(span),
            format!("a text of `{to}` is one word: `!{}!` is left out", material.text.trim()),
        );
        material.text.clear();
    }
    material.weights = Some(Weights { reflection: material.specular, ..weights });
}

/// kt from the weight of transmission, as near as it comes.
pub(super) fn transmission_coefficient(
    specular: Color,
    transmission: Color,
    at: Use,
    lost: &mut Lost,
) -> f64 {
    let most = specular.max_element();
    let kt = if most > 0.0 { transmission.max_element() / most } else { 0.0 };
    if !same(kt * specular, transmission) {
        lose(lost, Some(at.span), format!("transparency becomes kt = {kt} of the highlight's colour"));
    }
    kt
}

/// ks and kt from weights, as near as they come.
fn to_coefficients(material: &mut Material, weights: Weights, span: Span, lost: &mut Lost) {
    let ks = weights.shininess / 128.0;
    if !same(ks * material.specular, weights.reflection) {
        let message = format!("the mirror's weight becomes ks = {ks} of the highlight's colour");
        lose(lost, Some(span), message);
    }
    let at = Use { to: Dialect::Slides, span };
    let kt = transmission_coefficient(material.specular, weights.transmission, at, lost);
    (material.k_specular, material.k_transmission) = (ks, kt);
}

/// The lights, with what only some dialects can say of them.
fn lights(file: &mut SceneFile, to: Dialect, lost: &mut Lost) -> Vec<Placed<Light>> {
    let mut tints = std::mem::take(&mut file.tints);
    tints.resize(file.lights.len(), Tint::PLAIN);
    let mut new = Vec::new();
    for (Placed { value, span }, tint) in std::mem::take(&mut file.lights).into_iter().zip(&tints) {
        let mut value = value;
        if let (Light::Area { color, position, attenuation, .. }, true) = (value, to != Dialect::Slides) {
            lose(lost, Some(span), format!("`{to}` has no area light: it becomes a point"));
            value = Light::Point { color, position, attenuation };
        }
        if to != Dialect::Jhu && *tint != Tint::PLAIN {
            let color = color_of(&mut value);
            let parts = [tint.ambient, tint.diffuse, tint.specular].map(|part| part * *color);
            if parts[0] != Vec3::ZERO {
                lose(lost, Some(span), format!("a light of `{to}` has no ambient colour of its own"));
            }
            if parts[1] != parts[2] {
                lose(
                    lost,
                    Some(span),
                    format!("a light of `{to}` has one colour: that of the highlights is lost"),
                );
            }
            *color = parts[1];
        }
        new.push(Placed { value, span });
    }
    if to == Dialect::Jhu {
        file.tints = tints;
    }
    new
}

fn color_of(light: &mut Light) -> &mut Color {
    match light {
        Light::Point { color, .. }
        | Light::Spot { color, .. }
        | Light::Directional { color, .. }
        | Light::Area { color, .. } => color,
    }
}

/// Material -1 as a material like others.
fn write_default_material(file: &mut SceneFile) {
    let number = file.materials.len() as i32;
    let mut used = false;
    let mut each = |materials: &mut Vec<i32>| {
        for material in materials.iter_mut().filter(|material| **material < 0) {
            (*material, used) = (number, true);
        }
    };
    each(&mut file.spheres.materials);
    each(&mut file.cuboids.materials);
    each(&mut file.cylinders.materials);
    each(&mut file.cones.materials);
    each(&mut file.triangles.materials);
    each(&mut file.indexed_triangles.materials);
    each(&mut file.tori.materials);
    each(&mut file.open_sides.materials);
    if !used {
        return;
    }
    let specular = Vec3::splat(0.8);
    let value = Material {
        ambient: Vec3::splat(0.2),
        diffuse: Vec3::splat(0.8),
        specular,
        emissive: Vec3::ZERO,
        k_specular: 1.0,
        k_transmission: 0.0,
        index_of_refraction: 1.0,
        texture: None,
        bump: None,
        text: String::new(),
        weights: Some(Weights { shininess: 128.0, reflection: specular, transmission: Vec3::ZERO }),
    };
    file.materials.push(Placed { value, span: Span::default() });
}

fn drop_runs(items: &mut Vec<Item>, gone: ShapeKind) {
    items.retain(|item| !matches!(item, Item::Run { kind, .. } if *kind == gone));
}

pub(super) fn push<T>(list: &mut ShapeList<T>, shape: T, material: i32) -> u32 {
    list.shapes.push(shape);
    list.materials.push(material);
    list.starts.push(0);
    list.shapes.len() as u32 - 1
}

/// Runs of one kind become other runs, shape by shape.
pub(super) fn replace_runs(
    file: &mut SceneFile,
    gone: ShapeKind,
    mut one: impl FnMut(&mut SceneFile, usize) -> Item,
) {
    for item in std::mem::take(&mut file.items) {
        match item {
            Item::Run { kind, first, count } if kind == gone => {
                for index in first..first + count {
                    let item = one(file, index as usize);
                    push_run(&mut file.items, item);
                }
            }
            Item::Run { .. } | Item::Open(_) | Item::Close | Item::Instance(_) => file.items.push(item),
        }
    }
}

/// Appends a run, to the last one where they belong together.
fn push_run(items: &mut Vec<Item>, new: Item) {
    if let (Some(Item::Run { kind, first, count }), Item::Run { kind: next, first: start, count: more }) =
        (items.last_mut(), new)
        && *kind == next
        && *first + *count == start
    {
        *count += more;
        return;
    }
    items.push(new);
}

fn close_open_sides(file: &mut SceneFile) {
    let sides = std::mem::take(&mut file.open_sides);
    replace_runs(file, ShapeKind::Open, |file, index| {
        let material = sides.materials[index];
        let (kind, first) = match sides.shapes[index] {
            OpenSide::Cylinder(shape) => (ShapeKind::Cylinder, push(&mut file.cylinders, shape, material)),
            OpenSide::Cone(shape) => (ShapeKind::Cone, push(&mut file.cones, shape, material)),
        };
        Item::Run { kind, first, count: 1 }
    });
}

/// Triangles that hold their own corners become triangles of shared vertices.
fn share_vertices(file: &mut SceneFile) {
    let triangles = std::mem::take(&mut file.triangles);
    replace_runs(file, ShapeKind::Triangle, |file, index| {
        let triangle = &triangles.shapes[index];
        let [positions, normals] = [triangle.vertices(), triangle.normals()];
        let base = file.vertices.len() as u32;
        for corner in 0..3 {
            file.vertices.push(Vertex {
                position: positions[corner],
                normal: normals[corner],
                texcoord: triangle.texcoords()[corner],
            });
        }
        if !file.vertex_colors.is_empty() {
            file.vertex_colors.resize(file.vertices.len(), None);
        }
        let corners = [base, base + 1, base + 2];
        let first = push(&mut file.indexed_triangles, corners, triangles.materials[index]);
        Item::Run { kind: ShapeKind::IndexedTriangle, first, count: 1 }
    });
}
