//! The outline of a scene, the files that it names, and its colours.

use crate::documents::Document;
use crate::refer::Named;
use crate::refer::existing;
use crate::refer::named_by;
use crate::statement::Statement;
use crate::statement::Statements;
use crate::statement::inner;
use crate::statement::slice;
use crate::text::Text;
use dotray_scene::Dialect;
use dotray_scene::directive::ArgumentKind;
use dotray_scene::directive::Directive;
use dotray_scene::directive::Spec;
use lsp_types::DocumentSymbol;
use lsp_types::Range;
use lsp_types::SymbolKind;
use std::path::PathBuf;

/// Groups deeper than this stand beside the innermost group that is shown: editors draw trees by calling themselves,
/// and readers of JSON are wont to stop at 128 levels, of which each group takes two.
const DEEPEST: usize = 40;
/// Neighbours of one kind beyond so many are one entry.
const ALONE: usize = 24;
/// So many entries are enough for an outline.
const MOST: usize = 20_000;

const OPENING: [Directive; 3] = [Directive::GroupBegin, Directive::JointBegin, Directive::ListBegin];
const CLOSING: [Directive; 3] = [Directive::GroupEnd, Directive::JointEnd, Directive::ListEnd];
/// What stands for nothing by itself.
const HINTS: [Directive; 6] = [
    Directive::LightNum,
    Directive::TextureNum,
    Directive::MaterialNum,
    Directive::VertexNum,
    Directive::RayFileNum,
    Directive::RayfileEnd,
];
/// What is named by its number.
const COUNTED: [Directive; 4] =
    [Directive::Material, Directive::Texture, Directive::Vertex, Directive::RayFile];

/// Neighbours of one kind, or one directive.
struct Entry {
    symbol: DocumentSymbol,
    directive: Directive,
    /// How many directives are in it; above 1 it stands for all of them.
    count: usize,
}

/// A group that is not closed yet.
struct Open {
    entry: Entry,
    inside: Level,
}

/// The entries of one group.
#[derive(Default)]
struct Level {
    entries: Vec<Entry>,
    /// How many of the last entries are of one kind.
    alike: usize,
}

impl Level {
    fn push(&mut self, entry: Entry) {
        let is_alike = self.entries.last().is_some_and(|last| {
            last.directive == entry.directive
                && last.symbol.children.is_none()
                && entry.symbol.children.is_none()
        });
        self.alike = if is_alike { self.alike + 1 } else { 1 };
        if self.alike <= ALONE {
            return self.entries.push(entry);
        }
        // The neighbours gathered so far become one.
        let first = self.entries.len().saturating_sub(ALONE);
        if self.alike == ALONE + 1 {
            let gathered = self.entries.drain(first + 1..).map(|entry| entry.count).sum::<usize>();
            if let Some(one) = self.entries.last_mut() {
                one.count += gathered;
            }
        }
        if let Some(one) = self.entries.last_mut() {
            one.count += entry.count;
            one.symbol.range.end = entry.symbol.range.end;
        }
    }

    fn symbols(self) -> Vec<DocumentSymbol> {
        let named = self.entries.into_iter().map(|mut entry| {
            if entry.count > 1 {
                entry.symbol.name = format!("{} × {}", word_of(&entry.symbol.name), entry.count);
                entry.symbol.detail = None;
            }
            entry.symbol
        });
        named.collect()
    }
}

/// The first word of a name: `sphere` of `sphere`, `material` of `material 3`.
fn word_of(name: &str) -> &str {
    name.split(' ').next().unwrap_or_default()
}

/// Groups, shapes, lights, materials and files, as a tree.
pub fn symbols(document: &Document) -> Vec<DocumentSymbol> {
    if document.is_too_large() {
        return Vec::new();
    }
    let Document { bytes, dialect, .. } = document;
    let text = Text::new(bytes);
    let mut outline = Outline { root: Level::default(), open: Vec::new(), too_deep: 0, numbers: [0; 4] };
    let mut kept = 0;
    for statement in Statements::new(bytes) {
        let Some(spec) = statement.spec(bytes, *dialect) else { continue };
        kept += usize::from(spec.directive != Directive::Vertex);
        if kept > MOST {
            break;
        }
        outline.take(&text, spec, &statement);
    }
    let end = text.end();
    while !outline.open.is_empty() {
        outline.close(end);
    }
    outline.root.symbols()
}

struct Outline {
    root: Level,
    open: Vec<Open>,
    /// How many groups are open beyond [`DEEPEST`].
    too_deep: usize,
    /// How many materials, textures, vertices and included files came.
    numbers: [usize; 4],
}

impl Outline {
    fn level(&mut self) -> &mut Level {
        self.open.last_mut().map_or(&mut self.root, |open| &mut open.inside)
    }

    fn take(&mut self, text: &Text<'_>, spec: &'static Spec, statement: &Statement) {
        let range = text.range(statement.word.start, statement.end);
        if OPENING.contains(&spec.directive) {
            let entry = self.entry(text, spec, statement, range);
            if self.open.len() < DEEPEST {
                self.open.push(Open { entry, inside: Level::default() });
            } else {
                self.too_deep += 1;
                self.level().push(entry);
            }
        } else if CLOSING.contains(&spec.directive) {
            match self.too_deep {
                0 => self.close(range.end),
                _ => self.too_deep -= 1,
            }
        } else if !HINTS.contains(&spec.directive) {
            let entry = self.entry(text, spec, statement, range);
            self.level().push(entry);
        }
    }

    /// Closes the innermost group; a stray end closes nothing.
    fn close(&mut self, end: lsp_types::Position) {
        let Some(Open { mut entry, inside }) = self.open.pop() else { return };
        entry.symbol.range.end = end;
        entry.symbol.children = Some(inside.symbols());
        self.level().push(entry);
    }

    fn entry(&mut self, text: &Text<'_>, spec: &'static Spec, statement: &Statement, range: Range) -> Entry {
        let bytes = text.bytes();
        let words: Vec<String> = statement.arguments.iter().map(|token| inner(bytes, *token)).collect();
        let plain = spec.word.trim_start_matches('#').trim_start_matches("shape_");
        let mut name = plain.trim_end_matches("_begin").to_owned();
        let counter = COUNTED.iter().position(|directive| *directive == spec.directive);
        if let Some(number) = counter.and_then(|counter| self.numbers.get_mut(counter)) {
            name = format!("{name} {number}");
            *number += 1;
        }
        #[allow(deprecated, reason = "the field has no other way to be filled")]
        let symbol = DocumentSymbol {
            name,
            detail: detail(spec, &words),
            kind: kind(spec.directive),
            tags: None,
            deprecated: None,
            range,
            selection_range: text.range(statement.word.start, statement.word.end),
            children: None,
        };
        Entry { symbol, directive: spec.directive, count: 1 }
    }
}

/// What tells one apart from its like.
fn detail(spec: &'static Spec, words: &[String]) -> Option<String> {
    const MOST: usize = 40;
    let joined = |from: usize, count: usize| {
        words.iter().skip(from).take(count).cloned().collect::<Vec<_>>().join(" ")
    };
    let text = if spec.directive == Directive::GroupBegin {
        matrix(words)?
    } else if spec.directive == Directive::Material {
        joined(3, 3)
    } else if spec.directive == Directive::Vertex {
        return None;
    } else {
        joined(0, 7)
    };
    let short: String = text.chars().take(MOST).collect();
    Some(short).filter(|short| !short.is_empty())
}

/// The shift of a matrix, which mostly says where a group is.
fn matrix(words: &[String]) -> Option<String> {
    let [_, _, _, x, _, _, _, y, _, _, _, z, ..] = words else { return None };
    Some(format!("at {x} {y} {z}"))
}

/// The signs of what is neither group nor shape.
const KINDS: [(Directive, SymbolKind); 13] = [
    (Directive::Camera, SymbolKind::INTERFACE),
    (Directive::Background, SymbolKind::CONSTANT),
    (Directive::Ambient, SymbolKind::CONSTANT),
    (Directive::LightPoint, SymbolKind::EVENT),
    (Directive::LightSpot, SymbolKind::EVENT),
    (Directive::LightDir, SymbolKind::EVENT),
    (Directive::LightArea, SymbolKind::EVENT),
    (Directive::Material, SymbolKind::STRUCT),
    (Directive::Texture, SymbolKind::FILE),
    (Directive::RayFile, SymbolKind::FILE),
    (Directive::KeyFile, SymbolKind::FILE),
    (Directive::Shader, SymbolKind::FILE),
    (Directive::RayFileInstance, SymbolKind::MODULE),
];

fn kind(directive: Directive) -> SymbolKind {
    if OPENING.contains(&directive) {
        return SymbolKind::NAMESPACE;
    }
    KINDS.into_iter().find(|(of, _)| *of == directive).map_or(SymbolKind::OBJECT, |(_, kind)| kind)
}

/// The files that a text names, and where: those that are there.
pub fn links(document: &Document) -> Vec<(Range, PathBuf)> {
    /// Each is looked for on disk.
    const MOST_FILES: usize = 1000;
    if document.is_too_large() {
        return Vec::new();
    }
    let Document { bytes, dialect, path, .. } = document;
    let text = Text::new(bytes);
    let files = Statements::new(bytes).flat_map(|statement| {
        let named = named_by(bytes, path, *dialect, &statement, 0);
        let token = statement.arguments.first().copied();
        match (named, token) {
            (Some(Named::File(places)), Some(token)) => Some((token, places)),
            _ => None,
        }
    });
    files
        .take(MOST_FILES)
        .filter_map(|(token, places)| Some((text.range(token.start, token.end), existing(&places)?.clone())))
        .collect()
}

/// The colours of a text, and where: three numbers that the table calls a colour.
pub fn colors(document: &Document) -> Vec<(Range, [f64; 3])> {
    const MOST_COLORS: usize = 5000;
    if document.is_too_large() {
        return Vec::new();
    }
    let Document { bytes, dialect, .. } = document;
    let text = Text::new(bytes);
    let found = Statements::new(bytes).flat_map(|statement| of_statement(bytes, *dialect, &statement));
    found.take(MOST_COLORS).map(|(start, end, color)| (text.range(start, end), color)).collect()
}

fn of_statement(bytes: &[u8], dialect: Dialect, statement: &Statement) -> Vec<(usize, usize, [f64; 3])> {
    let spec = statement.spec(bytes, dialect);
    let form = spec.and_then(|spec| spec.form(statement.count - statement.flags(bytes)));
    let mut place = statement.flags(bytes);
    let mut found = Vec::new();
    for group in form.into_iter().flat_map(|form| form.arguments) {
        let here = place;
        place += group.names.len();
        let is_color = group.kind == ArgumentKind::Number
            && matches!(group.names, [r, g, b] if r.ends_with('r') && g.ends_with('g') && b.ends_with('b'));
        let Some([r, g, b]) = statement.arguments.get(here..place).filter(|_| is_color) else { continue };
        let value = |token| std::str::from_utf8(slice(bytes, token)).ok()?.parse::<f64>().ok();
        if let (Some(red), Some(green), Some(blue)) = (value(*r), value(*g), value(*b)) {
            found.push((r.start, b.end, [red, green, blue]));
        }
    }
    found
}
