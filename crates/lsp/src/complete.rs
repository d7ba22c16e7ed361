//! What may come next: directives with their arguments, numbers of materials, names of files, clauses.

use crate::documents::Document;
use crate::refer::all_of;
use crate::refer::numbered;
use crate::spot::On;
use crate::spot::Spot;
use crate::statement::Statement;
use crate::text::Text;
use crate::words::CLAUSES;
use crate::words::about;
use crate::words::snippet;
use crate::words::usage;
use dotray_scene::Files;
use dotray_scene::directive::ArgumentKind;
use dotray_scene::directive::Directive;
use dotray_scene::directive::Spec;
use dotray_scene::directive::words_of;
use dotray_scene::files::Disk;
use dotray_scene::lex::Opened;
use lsp_types::CompletionItem;
use lsp_types::CompletionItemKind;
use lsp_types::CompletionTextEdit;
use lsp_types::Documentation;
use lsp_types::InsertTextFormat;
use lsp_types::MarkupContent;
use lsp_types::MarkupKind;
use lsp_types::Position;
use lsp_types::Range;
use lsp_types::TextEdit;
use std::path::Path;

/// More names than this help nobody.
const MOST_ITEMS: usize = 500;

/// What may stand at a place. `snippets` tells whether the editor knows places to go to in what it puts in.
pub fn complete(document: &Document, position: Position, snippets: bool) -> Vec<CompletionItem> {
    if document.is_too_large() {
        return Vec::new();
    }
    let bytes = &document.bytes;
    let text = Text::new(bytes);
    let at = text.offset(position);
    let spot = Spot::new(bytes, at);
    let asked = Asked { document, text: &text, spot: &spot, snippets };
    match spot.on {
        On::Comment => Vec::new(),
        On::Nothing => asked.directives(at, at),
        On::Word => spot.token().map_or_else(Vec::new, |word| asked.directives(word.start, word.end)),
        On::Open(Opened::Text, start) => asked.clauses(start + 1),
        On::Open(Opened::Quote, start) => asked.names(start + 1, at),
        On::Open(Opened::Comment, _) => Vec::new(),
        On::Argument(index) => asked.argument(index),
        On::Gap(index) => asked.gap(index),
    }
}

struct Asked<'a> {
    document: &'a Document,
    text: &'a Text<'a>,
    spot: &'a Spot,
    snippets: bool,
}

impl Asked<'_> {
    fn slice(&self, start: usize, end: usize) -> &[u8] {
        self.document.bytes.get(start..end).unwrap_or_default()
    }

    /// All directives of the dialect, in the place of bytes `start .. end`.
    fn directives(&self, start: usize, end: usize) -> Vec<CompletionItem> {
        let rest = self.document.bytes.get(end..).unwrap_or_default();
        let line_end = rest.iter().position(|byte| b"\r\n".contains(byte)).unwrap_or(rest.len());
        let line = rest.get(..line_end).unwrap_or_default();
        // Before arguments that are there already only the word is wanted.
        let bare =
            line.iter().any(|byte| !byte.is_ascii_whitespace()) && !line.trim_ascii().starts_with(b"/");
        let range = self.text.range(start, end);
        let specs = words_of(self.document.dialect).enumerate();
        specs.flat_map(|(rank, spec)| self.directive(rank, spec, range, bare)).collect()
    }

    fn directive(&self, rank: usize, spec: &'static Spec, range: Range, bare: bool) -> Vec<CompletionItem> {
        let item = |number: usize, text: String, detail: String, format| CompletionItem {
            label: spec.word.to_owned(),
            kind: Some(CompletionItemKind::KEYWORD),
            detail: Some(detail),
            documentation: Some(markdown(about(spec))),
            sort_text: Some(format!("{rank:03}{number}")),
            filter_text: Some(spec.word.to_owned()),
            insert_text_format: Some(format),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, text))),
            ..CompletionItem::default()
        };
        if bare || spec.forms.is_empty() {
            return vec![item(
                0,
                spec.word.to_owned(),
                spec.meaning.to_owned(),
                InsertTextFormat::PLAIN_TEXT,
            )];
        }
        let forms = spec.forms.iter().enumerate();
        let items = forms.map(|(number, form)| match self.snippets {
            true => item(number, snippet(spec, form), usage(spec, form), InsertTextFormat::SNIPPET),
            false => item(number, spec.word.to_owned(), usage(spec, form), InsertTextFormat::PLAIN_TEXT),
        });
        items.collect()
    }

    /// Within a word that is there.
    fn argument(&self, index: usize) -> Vec<CompletionItem> {
        let Some(token) = self.spot.token() else { return Vec::new() };
        let first = self.slice(token.start, token.start + 1);
        let inside = token.start < self.spot.at;
        match (self.kind(index), first) {
            (Some((ArgumentKind::Text, _)), b"!") if inside && self.spot.at < token.end => {
                self.clauses(token.start + 1)
            }
            (Some((ArgumentKind::Name, _)), b"\"") if inside => self.names(token.start + 1, self.spot.at),
            (Some((ArgumentKind::Name, _)), _) => self.names(token.start, token.end),
            (Some((ArgumentKind::Integer, name)), _) => self.numbers(name, token.start, token.end),
            (Some((ArgumentKind::Text | ArgumentKind::Number, _)) | None, _) => Vec::new(),
        }
    }

    /// On a blank: what the next argument may be; behind the last one, or on a line of its own, a directive.
    fn gap(&self, index: usize) -> Vec<CompletionItem> {
        let at = self.spot.at;
        match self.kind(index) {
            Some((ArgumentKind::Name, _)) => self.names(at, at),
            Some((ArgumentKind::Integer, name)) => self.numbers(name, at, at),
            Some((ArgumentKind::Number | ArgumentKind::Text, _)) if !self.begins_line() => Vec::new(),
            Some(_) | None => self.directives(at, at),
        }
    }

    fn begins_line(&self) -> bool {
        let before = self.slice(0, self.spot.at);
        let blanks = before.iter().rev().take_while(|byte| **byte != b'\n');
        blanks.into_iter().all(|byte| byte.is_ascii_whitespace())
    }

    /// The kind and name of the argument of this number.
    fn kind(&self, index: usize) -> Option<(ArgumentKind, &'static str)> {
        let statement = self.spot.statement.as_ref()?;
        let spec = statement.spec(&self.document.bytes, self.document.dialect)?;
        let bytes = &self.document.bytes;
        let (name, group) = if matches!(self.spot.on, On::Gap(_)) {
            grown(statement).argument(bytes, spec, index)?
        } else {
            statement.argument(bytes, spec, index)?
        };
        Some((group.kind, name))
    }

    /// The numbers of what the text declares.
    fn numbers(&self, argument: &str, start: usize, end: usize) -> Vec<CompletionItem> {
        const NONE: [(Directive, &str); 2] =
            [(Directive::Material, "the default material"), (Directive::Texture, "no texture")];
        let Document { bytes, dialect, .. } = self.document;
        let spec = self.spot.statement.as_ref().and_then(|statement| statement.spec(bytes, *dialect));
        let Some(kind) = spec.and_then(|spec| numbered(spec.directive, argument)) else { return Vec::new() };
        let range = self.text.range(start, end);
        let item = |rank: usize, label: String, detail: String| CompletionItem {
            label: label.clone(),
            kind: Some(CompletionItemKind::REFERENCE),
            detail: Some(detail),
            sort_text: Some(format!("{rank:04}")),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, label))),
            ..CompletionItem::default()
        };
        let declared = all_of(bytes, *dialect, kind).take(MOST_ITEMS).enumerate();
        let mut items: Vec<CompletionItem> = declared
            .map(|(number, statement)| item(number, number.to_string(), shown(bytes, &statement)))
            .collect();
        let none = NONE.into_iter().find(|(of, _)| *of == kind).map(|(_, meaning)| meaning);
        items.extend(none.map(|meaning| item(MOST_ITEMS, "-1".to_owned(), meaning.to_owned())));
        items
    }

    /// The names of files in the folder that is named so far, `start` being where the name begins.
    fn names(&self, start: usize, end: usize) -> Vec<CompletionItem> {
        let typed = String::from_utf8_lossy(self.slice(start, self.spot.at.max(start))).replace('\\', "/");
        let folder = typed.rfind('/').map_or("", |at| typed.get(..=at).unwrap_or_default());
        let base = self.document.path.parent().unwrap_or(Path::new(""));
        let whole = base.join(folder);
        let is_scene = self.spot.statement.as_ref().is_some_and(|statement| {
            self.slice(statement.word.start, statement.word.end).eq_ignore_ascii_case(b"#ray_file")
        });
        let range = self.text.range((start + folder.len()).min(end), end);
        let quoted = start > 0 && self.slice(start - 1, start) == b"\"";
        let names = Disk.names_in(&whole).into_iter().filter(|name| !name.starts_with('.'));
        let wanted = names.filter_map(|name| {
            let is_folder = whole.join(&name).is_dir();
            let fits = is_folder || is_fit(&name, is_scene);
            let writable = quoted || !name.contains(char::is_whitespace);
            (fits && writable).then(|| (if is_folder { format!("{name}/") } else { name }, is_folder))
        });
        let item = |(name, is_folder): (String, bool)| CompletionItem {
            label: name.clone(),
            kind: Some(if is_folder { CompletionItemKind::FOLDER } else { CompletionItemKind::FILE }),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, name))),
            ..CompletionItem::default()
        };
        wanted.take(MOST_ITEMS).map(item).collect()
    }

    /// Within a `!…!` that begins at byte `start`: clauses, and the keys of the one at hand.
    fn clauses(&self, start: usize) -> Vec<CompletionItem> {
        let typed = String::from_utf8_lossy(self.slice(start, self.spot.at)).into_owned();
        let clause = typed.rsplit(';').next().unwrap_or_default();
        let word = clause.rsplit(char::is_whitespace).next().unwrap_or_default();
        if word.contains('=') {
            return Vec::new();
        }
        let range = self.text.range(self.spot.at - word.len().min(self.spot.at - start), self.spot.at);
        let item = |label: &str, text: String, detail: String, kind| CompletionItem {
            label: label.to_owned(),
            kind: Some(kind),
            detail: Some(detail),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(range, text))),
            ..CompletionItem::default()
        };
        let name = clause.split_whitespace().next().unwrap_or_default();
        let known = CLAUSES.iter().find(|clause| clause.name == name).filter(|_| clause.trim_start() != word);
        match known {
            Some(known) => {
                let keys = known.keys.iter();
                keys.map(|key| {
                    let detail = format!("{}; {} where it is not given", key.meaning, key.default);
                    item(key.name, format!("{}=", key.name), detail, CompletionItemKind::PROPERTY)
                })
                .collect()
            }
            None if clause.trim_start() == word => CLAUSES
                .iter()
                .map(|clause| {
                    let (text, meaning) = (clause.name.to_owned(), clause.meaning.to_owned());
                    item(clause.name, text, meaning, CompletionItemKind::FUNCTION)
                })
                .collect(),
            None => Vec::new(),
        }
    }
}

/// A statement with one more argument, as the one about to be typed will make it.
pub fn grown(statement: &Statement) -> Statement {
    Statement { count: statement.count + 1, ..statement.clone() }
}

fn is_fit(name: &str, is_scene: bool) -> bool {
    const PICTURES: [&str; 11] =
        ["bmp", "png", "jpg", "jpeg", "ppm", "pgm", "qoi", "tif", "tiff", "hdr", "exr"];
    const SCENES: [&str; 2] = ["ray", "scene"];
    let Some((_, extension)) = name.rsplit_once('.') else { return false };
    let extension = extension.to_ascii_lowercase();
    if is_scene { SCENES.contains(&extension.as_str()) } else { PICTURES.contains(&extension.as_str()) }
}

/// A directive with its arguments on one short line.
pub fn shown(bytes: &[u8], statement: &Statement) -> String {
    const MOST: usize = 100;
    let source = bytes.get(statement.word.start..statement.end).unwrap_or_default();
    let source = String::from_utf8_lossy(source.get(..4 * MOST).unwrap_or(source)).into_owned();
    let line = source.split_whitespace().collect::<Vec<_>>().join(" ");
    let short: String = line.chars().take(MOST).collect();
    if short.len() < line.len() { short + "…" } else { short }
}

/// Text in Markdown.
fn markdown(value: String) -> Documentation {
    Documentation::MarkupContent(MarkupContent { kind: MarkupKind::Markdown, value })
}
