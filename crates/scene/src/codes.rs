//! Every code of a message about a scene: what it means at length, and an example that gives it.

mod foreign;
mod page;
mod reader;
mod scene;

pub use page::explain;
pub use page::messages_page;

use crate::diagnostic::READER_CODES;
use crate::diagnostic::Severity;
use crate::lint::LINT_CODES;
use crate::resolve::RESOLVER_CODES;

/// The codes of textures: the images are opened by whoever renders or checks a scene, never here.
pub const TEXTURE_CODES: &[(&str, Severity, &str)] = &[
    (
        "texture-not-found",
        Severity::Error,
        "A texture's file was not found; the folders searched are listed.",
    ),
    (
        "texture-unreadable",
        Severity::Error,
        "A texture's file is there, but is no picture that can be decoded.",
    ),
];

/// A code at length.
#[derive(Clone, Copy, Debug)]
pub struct Explanation {
    /// The code.
    pub code: &'static str,
    /// A paragraph: why it is said and what to do.
    pub text: &'static str,
    /// A file that gives this message; `None` where no file can.
    pub example: Option<Example>,
    /// The example put right; empty where there is none.
    pub repaired: &'static str,
}

/// A scene that gives a message.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// The lines that matter.
    pub text: &'static str,
    /// Files beside it, by name and content; one without content is there, but cannot be read.
    pub parts: &'static [(&'static str, Option<&'static str>)],
    /// A limit so low that the example passes it.
    pub limit: Option<(&'static str, u32)>,
}

/// A code with its severity and its meaning in one sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// The code itself.
    pub name: &'static str,
    /// Whether it is an error.
    pub severity: Severity,
    /// What it means.
    pub meaning: &'static str,
}

/// All codes by name, each once.
pub fn all_codes() -> Vec<Code> {
    let lists = [READER_CODES, RESOLVER_CODES, LINT_CODES, TEXTURE_CODES];
    let codes = lists.into_iter().flatten();
    let mut all: Vec<Code> =
        codes.map(|&(name, severity, meaning)| Code { name, severity, meaning }).collect();
    // Where reader and resolver share a code, the reader's words stand first and stay.
    all.sort_by_key(|code| code.name);
    all.dedup_by_key(|code| code.name);
    all
}

/// The code of this name.
pub fn code(name: &str) -> Option<Code> {
    all_codes().into_iter().find(|code| code.name == name)
}

/// What there is to say about a code.
pub fn explanation(name: &str) -> Option<&'static Explanation> {
    explanations().find(|explanation| explanation.code == name)
}

/// All explanations.
pub fn explanations() -> impl Iterator<Item = &'static Explanation> {
    let own = reader::EXPLANATIONS.iter().chain(scene::EXPLANATIONS);
    own.chain(foreign::EXPLANATIONS).chain(foreign::FORCED)
}

const fn explained(
    code: &'static str,
    text: &'static str,
    example: &'static str,
    repaired: &'static str,
) -> Explanation {
    Explanation { code, text, example: Some(Example { text: example, parts: &[], limit: None }), repaired }
}

const fn with_parts(
    explanation: Explanation,
    parts: &'static [(&'static str, Option<&'static str>)],
) -> Explanation {
    let example = match explanation.example {
        Some(example) => Some(Example { parts, ..example }),
        None => None,
    };
    Explanation { example, ..explanation }
}

const fn with_limit(explanation: Explanation, name: &'static str, value: u32) -> Explanation {
    let example = match explanation.example {
        Some(example) => Some(Example { limit: Some((name, value)), ..example }),
        None => None,
    };
    Explanation { example, ..explanation }
}
