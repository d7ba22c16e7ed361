//! What `dotray check` says about a scene, as the protocol has it. Whether a texture's file is a picture that can be
//! decoded is not looked at: that is for those who render.

use crate::documents::Document;
use crate::documents::Documents;
use crate::documents::MOST_BYTES;
use crate::documents::Overlay;
use crate::refer::existing;
use crate::repair::Repair;
use crate::repair::repair;
use crate::text::Text;
use dotray_scene::Diagnostic;
use dotray_scene::Dialect;
use dotray_scene::Files;
use dotray_scene::Severity;
use dotray_scene::Sources;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::look_over::look_over;
use dotray_scene::resolve;
use dotray_scene::resolved::ResolvedTexture;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;
use dotray_scene::textures::Hints;
use dotray_scene::textures::not_found;
use lsp_types::CodeDescription;
use lsp_types::DiagnosticRelatedInformation;
use lsp_types::DiagnosticSeverity;
use lsp_types::DiagnosticTag;
use lsp_types::Location;
use lsp_types::NumberOrString;
use lsp_types::Range;
use lsp_types::TextEdit;
use lsp_types::Uri;
use std::collections::HashMap;
use std::path::PathBuf;
use std::str::FromStr;

/// How the scenes are read.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// The dialect; `None` finds out.
    pub dialect: Option<Dialect>,
    /// The folder that is open in the editor.
    pub folder: Option<PathBuf>,
}

/// A message and where it is to be shown.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The file's address.
    pub uri: Uri,
    /// The message.
    pub diagnostic: lsp_types::Diagnostic,
    /// Its code.
    pub code: &'static str,
    /// A likely repair: its title and the change.
    pub repair: Option<(String, TextEdit)>,
}

/// What a look at a text found.
#[derive(Clone, Debug, Default)]
pub struct Checked {
    /// The messages.
    pub findings: Vec<Finding>,
    /// The files that it includes, in one form for each file.
    pub includes: Vec<PathBuf>,
    /// The dialect that it was read in.
    pub dialect: Dialect,
}

/// Included files of so many bytes are read, and so many shapes; an editor does not wait for more.
const MOST_INCLUDED: u64 = 64 << 20;
const MOST_SHAPES: u64 = 4_000_000;

/// Codes of messages about limits, which for the program may be no faults.
const LIMITS: [&str; 3] = ["file-too-large", "too-many-shapes", "include-limit"];
/// Codes of what can go without a change of the picture.
const UNNECESSARY: [&str; 4] = ["degenerate-shape", "duplicate-shape", "enclosed-shape", "unused-include"];

/// Looks a text over, with the other open ones in the place of what is on disk.
pub fn check(document: &Document, documents: &Documents, reading: &Reading) -> Checked {
    let overlay = Overlay(documents);
    if document.is_too_large() {
        return too_large(document);
    }
    let mut options = LoadOptions {
        dialect: reading.dialect,
        working_directory: reading.folder.clone(),
        ..LoadOptions::default()
    };
    options.limits.max_file_bytes = MOST_INCLUDED;
    let name = document.path.display().to_string();
    let loaded = load_text(&name, document.bytes.clone(), &overlay, &options);
    let dialect = loaded.dialect;
    let limits = resolve::Limits { shapes: MOST_SHAPES, ..resolve::Limits::default() };
    let (diagnostics, sources) = look_over(loaded, &limits, missing);
    let count = u32::try_from(sources.len()).unwrap_or(u32::MAX);
    let includes = (1..count).map(|file| Disk.identity(sources.path(FileId(file)))).collect();
    let mut writer =
        Writer { overlay, sources: &sources, texts: HashMap::new(), uris: HashMap::new(), document };
    let findings = diagnostics.iter().map(|diagnostic| writer.finding(diagnostic)).collect();
    Checked { findings, includes, dialect }
}

/// The textures whose files are nowhere.
fn missing(textures: &[ResolvedTexture]) -> Vec<Diagnostic> {
    /// Each is looked for on disk.
    const MOST: usize = 1000;
    let looked_for = textures.iter().take(MOST).filter(|texture| existing(&texture.candidates).is_none());
    let mut hints = Hints::new(&Disk);
    looked_for.map(|texture| not_found(&mut hints, texture, Vec::new())).collect()
}

fn too_large(document: &Document) -> Checked {
    let message = format!(
        "the text has {} MiB; beyond {} MiB the editor gets no help with it (`dotray check` reads it all the same)",
        document.bytes.len() >> 20,
        MOST_BYTES >> 20
    );
    let diagnostic = lsp_types::Diagnostic {
        severity: Some(DiagnosticSeverity::INFORMATION),
        source: Some("dotray".to_owned()),
        message,
        ..lsp_types::Diagnostic::default()
    };
    let finding = Finding { uri: document.uri.clone(), diagnostic, code: "text-too-large", repair: None };
    Checked { findings: vec![finding], dialect: document.dialect, ..Checked::default() }
}

/// Turns messages into those of the protocol.
struct Writer<'a> {
    overlay: Overlay<'a>,
    sources: &'a Sources,
    texts: HashMap<FileId, Text<'a>>,
    uris: HashMap<FileId, Uri>,
    document: &'a Document,
}

impl Writer<'_> {
    fn range(&mut self, span: Span) -> Range {
        let sources = self.sources;
        let text = self.texts.entry(span.file).or_insert_with(|| Text::new(sources.bytes(span.file)));
        let byte = |at: u64| usize::try_from(at).unwrap_or(usize::MAX);
        text.range(byte(span.start), byte(span.end))
    }

    fn uri(&mut self, file: FileId) -> Uri {
        if file == FileId(0) || file.0 as usize >= self.sources.len() {
            return self.document.uri.clone();
        }
        let (overlay, path) = (&self.overlay, self.sources.path(file));
        let uri = self.uris.entry(file);
        uri.or_insert_with(|| overlay.uri(path).unwrap_or_else(|| self.document.uri.clone())).clone()
    }

    fn finding(&mut self, diagnostic: &Diagnostic) -> Finding {
        let span = diagnostic.span;
        let uri = self.uri(span.map_or(FileId(0), |span| span.file));
        let range = span.map_or_else(Range::default, |span| self.range(span));
        let related: Vec<DiagnosticRelatedInformation> =
            diagnostic.notes.iter().filter_map(|(at, message)| Some(self.related((*at)?, message))).collect();
        let repair = span.and_then(|span| repair(diagnostic, self.sources.bytes(span.file)));
        let repair = repair.zip(span).map(|(repair, span)| {
            let Repair { title, start, end, text } = repair;
            (title, TextEdit::new(self.range(Span::new(span.file, start, end)), text))
        });
        let code = diagnostic.code;
        let diagnostic = lsp_types::Diagnostic {
            range,
            severity: Some(severity(diagnostic)),
            code: Some(NumberOrString::String(diagnostic.code.to_owned())),
            code_description: description(diagnostic.code),
            source: Some("dotray".to_owned()),
            message: in_words(diagnostic),
            related_information: (!related.is_empty()).then_some(related),
            tags: UNNECESSARY.contains(&diagnostic.code).then(|| vec![DiagnosticTag::UNNECESSARY]),
            data: None,
        };
        Finding { uri, diagnostic, code, repair }
    }

    fn related(&mut self, span: Span, message: &str) -> DiagnosticRelatedInformation {
        let location = Location::new(self.uri(span.file), self.range(span));
        DiagnosticRelatedInformation { location, message: message.to_owned() }
    }
}

fn severity(diagnostic: &Diagnostic) -> DiagnosticSeverity {
    match diagnostic.severity {
        Severity::Error if LIMITS.contains(&diagnostic.code) => DiagnosticSeverity::WARNING,
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
    }
}

/// Where the code is explained.
fn description(code: &str) -> Option<CodeDescription> {
    let page = format!("{}/blob/main/docs/messages.md#{code}", env!("CARGO_PKG_REPOSITORY"));
    Some(CodeDescription { href: Uri::from_str(&page).ok()? })
}

/// The sentence and all that is said besides about no other place.
fn in_words(diagnostic: &Diagnostic) -> String {
    let mut lines = vec![diagnostic.message.clone()];
    if !diagnostic.label.is_empty() {
        lines.push(diagnostic.label.clone());
    }
    let notes = diagnostic.notes.iter().filter(|(span, _)| span.is_none());
    lines.extend(notes.map(|(_, note)| format!("note: {note}")));
    lines.extend(diagnostic.help.iter().map(|help| format!("help: {help}")));
    lines.join("\n")
}

/// Messages that only a whole scene deserves, not a part that others include.
pub fn is_for_wholes(code: &str) -> bool {
    ["no-camera", "no-light"].contains(&code)
}
