//! Which dialect a file is written in, told by what only that dialect has.
//!
//! Only files that are faulty as slides files are looked at, so that a slides file is never taken for another.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::lex;
use crate::lex::Lexer;
use crate::lex::Token;
use crate::lex::TokenKind;
use crate::lookalike;
use crate::span::FileId;
use crate::span::Span;
use std::path::Path;

/// What speaks for one dialect.
#[derive(Clone, Copy, Debug, Default)]
struct Evidence {
    count: usize,
    /// The first place and what stands there.
    first: Option<(Span, &'static str)>,
}

/// What speaks for each dialect, gathered from any number of files.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    slides: Evidence,
    uva: Evidence,
    jhu: Evidence,
    hmc: Evidence,
    unisa: Evidence,
    /// Materials of 17 arguments: `slides` or `unisa`.
    short_materials: Evidence,
    /// Materials of 19 arguments: `uva` or `jhu`.
    long_materials: Evidence,
    /// Programs for graphics cards: `unisa` or `jhu`.
    shaders: Evidence,
    /// Key frames: `uva` or `jhu`.
    key_files: Evidence,
    /// Whether a file's name ends in `.scene`.
    named_scene: bool,
}

/// What was found out.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The dialect.
    pub dialect: Dialect,
    /// What spoke for it.
    pub because: Option<(Span, &'static str)>,
    /// A warning where something speaks for others as well, or an error where that weighs as much.
    pub doubt: Option<Diagnostic>,
}

/// One directive and its arguments.
struct Seen<'a> {
    word: &'a [u8],
    span: Span,
    arguments: usize,
    first: Option<Token>,
}

impl Evidence {
    fn add(&mut self, span: Span, what: &'static str) {
        self.count += 1;
        self.first.get_or_insert((span, what));
    }

    fn with(mut self, other: Self) -> Self {
        self.count += other.count;
        self.first = self.first.or(other.first);
        self
    }
}

impl Marks {
    /// Whether anything speaks for any dialect.
    pub fn is_empty(&self) -> bool {
        let Self { slides, uva, jhu, hmc, unisa, short_materials, long_materials, .. } = self;
        let certain = [slides, uva, jhu, hmc, unisa, short_materials, long_materials];
        certain.into_iter().chain([&self.shaders, &self.key_files]).all(|mark| mark.count == 0)
    }

    /// Gathers what one file has; answers with the names of the files that it includes.
    pub fn scan(&mut self, path: &Path, bytes: &[u8], file: FileId) -> Vec<String> {
        self.named_scene |= path.extension().is_some_and(|e| e.eq_ignore_ascii_case("scene"));
        let mut includes = Vec::new();
        let mut lexer = Lexer::new(bytes);
        let mut seen: Option<Seen<'_>> = None;
        loop {
            // What is left open is told by the reader.
            let Ok(token) = lexer.token() else { continue };
            let is_directive = token.is_none_or(|token| token.kind == TokenKind::Directive);
            if is_directive && let Some(seen) = seen.take() {
                self.judge(&seen, &lexer);
                if seen.word.eq_ignore_ascii_case(b"#ray_file") {
                    includes.extend(seen.first.map(|token| text(lexer.inner(token))));
                }
            }
            match (token, &mut seen) {
                (None, _) => return includes,
                (Some(token), _) if is_directive => {
                    let span = Span::new(file, token.start, token.end);
                    seen = Some(Seen { word: lexer.text(token), span, arguments: 0, first: None });
                }
                (Some(token), Some(seen)) => {
                    seen.arguments += 1;
                    seen.first.get_or_insert(token);
                }
                (Some(_), None) => {}
            }
        }
    }

    fn judge(&mut self, seen: &Seen<'_>, lexer: &Lexer<'_>) {
        let Seen { word, span, arguments, first } = seen;
        let lower = word.to_ascii_lowercase();
        let first = first.map(|token| lexer.text(token)).unwrap_or_default();
        let flag = first.starts_with(b"-") && first.get(1).is_some_and(|sign| !sign.is_ascii_digit());
        if lower == b"#version" && first.starts_with(b"HMC") {
            self.hmc.count += DECISIVE;
        }
        match (lower.as_slice(), arguments) {
            (b"#material", 17) => self.short_materials.add(*span, "a material of 17 arguments"),
            (b"#material", 19) => self.long_materials.add(*span, "a material of 19 arguments"),
            (b"#light_point", 15) | (b"#light_spot", 20) | (b"#light_dir", 12) => {
                self.jhu.add(*span, "a light of three colours");
            }
            (b"#shape_triangle", 25) => self.slides.add(*span, "a triangle of 25 arguments"),
            (b"#light_area", 13) => self.slides.add(*span, "`#light_area`"),
            (b"#shape_side", 6 | 7) => self.slides.add(*span, "`#shape_side`"),
            (b"#vertex", 11) => self.unisa.add(*span, "a vertex of 11 numbers"),
            _other if lookalike::is_solid_geometry(word) => self.jhu.add(*span, "solid geometry"),
            _other if flag && lex::number(first).is_err() => self.hmc.add(*span, "a directive with flags"),
            _other => self.by_word(word, *span),
        }
    }

    fn by_word(&mut self, word: &[u8], span: Span) {
        if word.eq_ignore_ascii_case(b"#shader") {
            return self.shaders.add(span, "a shader");
        }
        if word.eq_ignore_ascii_case(b"#key_file") {
            return self.key_files.add(span, "key frames");
        }
        match lookalike::foreign_directive(word).and_then(Dialect::of_name) {
            Some(Dialect::Uva) => self.uva.add(span, "a joint"),
            Some(Dialect::Jhu) => self.jhu.add(span, "a directive of that dialect"),
            Some(Dialect::Hmc) => self.hmc.add(span, "a directive of that dialect"),
            Some(Dialect::Unisa) => self.unisa.add(span, "a directive of that dialect"),
            Some(Dialect::Slides) | None => {}
        }
    }

    /// Weighs the marks.
    pub fn verdict(&self) -> Verdict {
        let found = |evidence: &Evidence| evidence.count > 0;
        let of_jhu = found(&self.jhu);
        let has_shaders = found(&self.shaders) && !of_jhu;
        let of_unisa = found(&self.unisa) || has_shaders || (self.named_scene && !found(&self.slides));
        let shared = |mark: Evidence, here: bool| if here { mark } else { Evidence::default() };
        let short = |here: bool| if here { self.short_materials } else { Evidence::default() };
        let long = |here: bool| if here { self.long_materials } else { Evidence::default() };
        let mut weighed = [
            (Dialect::Slides, self.slides.with(short(!of_unisa))),
            (Dialect::Uva, self.uva.with(long(!of_jhu)).with(shared(self.key_files, !of_jhu))),
            (
                Dialect::Jhu,
                self.jhu.with(long(of_jhu)).with(shared(self.key_files.with(self.shaders), of_jhu)),
            ),
            (Dialect::Hmc, self.hmc),
            (Dialect::Unisa, self.unisa.with(short(of_unisa)).with(shared(self.shaders, has_shaders))),
        ];
        // The sort keeps the order of equal ones, so that the slides stand before all others.
        weighed.sort_by_key(|(_, evidence)| std::cmp::Reverse(evidence.count));
        let [(dialect, best), (_, second), ..] = weighed;
        if best.count == 0 {
            let dialect = if self.named_scene { Dialect::Unisa } else { Dialect::Slides };
            return Verdict { dialect, because: None, doubt: None };
        }
        let tie = best.count == second.count && dialect != Dialect::Slides;
        let doubt = (second.count > 0 && best.count < DECISIVE).then(|| doubt(&weighed, dialect, tie));
        Verdict { dialect, because: best.first, doubt }
    }
}

/// A mark that outweighs all others.
const DECISIVE: usize = 1 << 30;

fn doubt(weighed: &[(Dialect, Evidence)], dialect: Dialect, tie: bool) -> Diagnostic {
    let candidates = weighed.iter().filter(|(_, evidence)| evidence.count > 0);
    let names: Vec<String> = candidates.clone().map(|(candidate, _)| format!("`{candidate}`")).collect();
    let names = names.join(" and ");
    let diagnostic = if tie {
        let message = format!("the file has marks of the dialects {names}, as many of each");
        Diagnostic::error("dialect-unclear", message).help("say which it is with `--dialect NAME`")
    } else {
        let message = format!("the file has marks of the dialects {names}; it is read as `{dialect}`");
        Diagnostic::warning("dialect-doubt", message).help("`--dialect NAME` says which it is")
    };
    let marks = candidates.filter_map(|(candidate, evidence)| Some((candidate, evidence.first?)));
    marks.fold(diagnostic, |diagnostic, (candidate, (span, what))| {
        diagnostic.note_at(span, format!("{what}: `{candidate}`"))
    })
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    fn verdict_of(name: &str, text: &str) -> Verdict {
        let mut marks = Marks::default();
        marks.scan(Path::new(name), text.as_bytes(), FileId(0));
        marks.verdict()
    }

    #[test]
    fn each_dialect_is_known_by_its_marks() {
        let short = "#material 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 -1 !!";
        let long = "#material 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 -1 !!";
        let cases = [
            ("a.ray", "#camera 0 0 0", Dialect::Slides),
            ("a.ray", short, Dialect::Slides),
            ("a.ray", long, Dialect::Uva),
            ("a.ray", &format!("{long} #static_affine"), Dialect::Jhu),
            ("a.ray", "#light_dir 1 1 1 1 1 1 1 1 1 0 -1 0", Dialect::Jhu),
            ("a.ray", "#union #shape_list_begin", Dialect::Jhu),
            ("a.ray", "#version HMCCS155FALL2002 #sphere -m a -- 0 0 0 1", Dialect::Hmc),
            ("a.ray", "#light_dir -n Sun -- 1 1 1 0 0 -1", Dialect::Hmc),
            ("a.ray", "#shader \"a\" \"b\"", Dialect::Unisa),
            ("a.ray", &format!("#shader a b #key_file c {long} #static_affine"), Dialect::Jhu),
            ("a.ray", &format!("#key_file c {long}"), Dialect::Uva),
            ("a.ray", &format!("{short} #vertex 1 1 1 1 1 1 1 1 1 1 1"), Dialect::Unisa),
            ("a.scene", &format!("#camera 0 0 0 0 0 -1 0 1 0 45 {short}"), Dialect::Unisa),
        ];
        for (name, text, dialect) in cases {
            let verdict = verdict_of(name, text);
            assert_eq!(verdict.dialect, dialect, "{text}");
            assert!(verdict.doubt.is_none(), "{text}: {:?}", verdict.doubt);
        }
    }

    #[test]
    fn doubt_names_the_candidates() {
        let mixed = "#material 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 -1 !! #joint_begin a #joint_end";
        let verdict = verdict_of("a.ray", mixed);
        assert_eq!(verdict.dialect, Dialect::Uva);
        let doubt = verdict.doubt.unwrap();
        assert_eq!((doubt.code, doubt.notes.len()), ("dialect-doubt", 2));
        assert!(doubt.message.contains("`uva` and `slides`"), "{}", doubt.message);
        let tie = verdict_of("a.ray", "#joint_begin a #sphere -- 0 0 0 1").doubt.unwrap();
        assert_eq!(tie.code, "dialect-unclear");
        let slides = verdict_of("a.ray", "#light_area 1 1 1 1 1 1 1 1 1 1 1 1 1 #shader a b");
        assert_eq!((slides.dialect, slides.doubt.unwrap().code), (Dialect::Slides, "dialect-doubt"));
    }
}
