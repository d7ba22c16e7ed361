//! A text as a list of directives with their arguments, whatever is wrong with it.

use dotray_scene::Dialect;
use dotray_scene::directive::Arguments;
use dotray_scene::directive::Form;
use dotray_scene::directive::Spec;
use dotray_scene::directive::find_in;
use dotray_scene::directive::find_in_any_dialect;
use dotray_scene::lex::Lexer;
use dotray_scene::lex::Token;
use dotray_scene::lex::TokenKind;
use dotray_scene::lex::Unterminated;

/// More arguments of one directive than this are counted, not kept.
const KEPT: usize = 64;

/// A directive and its arguments.
#[derive(Clone, Debug)]
pub struct Statement {
    /// The word.
    pub word: Token,
    /// Its arguments.
    pub arguments: Vec<Token>,
    /// How many there are.
    pub count: usize,
    /// What is opened among them and never closed.
    pub open: Option<Unterminated>,
    /// The byte after the last argument.
    pub end: usize,
}

/// The directives of a text, in order.
pub struct Statements<'a> {
    lexer: Lexer<'a>,
    next: Option<Token>,
}

impl<'a> Statements<'a> {
    /// The directives of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { lexer: Lexer::new(bytes), next: None }
    }

    /// The next directive; words before it belong to none.
    fn word(&mut self) -> Option<Token> {
        if let Some(word) = self.next.take() {
            return Some(word);
        }
        loop {
            match self.lexer.token() {
                Ok(Some(token)) if token.kind == TokenKind::Directive => return Some(token),
                Ok(None) => return None,
                // The lexer stands behind what is not closed.
                Ok(Some(_)) | Err(_) => {}
            }
        }
    }
}

impl Iterator for Statements<'_> {
    type Item = Statement;

    fn next(&mut self) -> Option<Statement> {
        let word = self.word()?;
        let mut statement = Statement { word, arguments: Vec::new(), count: 0, open: None, end: word.end };
        loop {
            match self.lexer.token() {
                Ok(Some(token)) if token.kind == TokenKind::Directive => {
                    self.next = Some(token);
                    return Some(statement);
                }
                Ok(Some(token)) => {
                    statement.count += 1;
                    statement.end = token.end;
                    if statement.arguments.len() < KEPT {
                        statement.arguments.push(token);
                    }
                }
                Ok(None) => return Some(statement),
                Err(open) => {
                    statement.open.get_or_insert(open);
                    statement.end = statement.end.max(self.lexer.at());
                }
            }
        }
    }
}

impl Statement {
    /// What is known of its word.
    pub fn spec(&self, bytes: &[u8], dialect: Dialect) -> Option<&'static Spec> {
        const LONGEST: usize = 64;
        let word = slice(bytes, self.word);
        if word.len() > LONGEST {
            return None;
        }
        let lower = word.to_ascii_lowercase();
        find_in(dialect, &lower).or_else(|| find_in_any_dialect(&lower))
    }

    /// How many words before the arguments are flags: those up to `--`, where there is one.
    pub fn flags(&self, bytes: &[u8]) -> usize {
        let end = self.arguments.iter().position(|token| slice(bytes, *token) == b"--");
        end.map_or(0, |end| end + 1)
    }

    /// The form that fits the number of arguments, or that may still come to fit.
    pub fn form(&self, bytes: &[u8], spec: &'static Spec) -> Option<&'static Form> {
        let count = self.count - self.flags(bytes);
        let may_grow = || spec.forms.iter().filter(|form| form.count > count).min_by_key(|form| form.count);
        let largest = || spec.forms.iter().max_by_key(|form| form.count);
        spec.form(count).or_else(may_grow).or_else(largest)
    }

    /// The name and group of argument `index`, flags counted.
    pub fn argument(
        &self,
        bytes: &[u8],
        spec: &'static Spec,
        index: usize,
    ) -> Option<(&'static str, &'static Arguments)> {
        let index = index.checked_sub(self.flags(bytes))?;
        self.form(bytes, spec)?.each().nth(index)
    }
}

/// The bytes of a token.
pub fn slice(bytes: &[u8], token: Token) -> &[u8] {
    bytes.get(token.start..token.end).unwrap_or_default()
}

/// The words of a token, without the signs around them.
pub fn inner(bytes: &[u8], token: Token) -> String {
    String::from_utf8_lossy(Lexer::new(bytes).inner(token)).into_owned()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;
    use dotray_scene::directive::Directive;

    #[test]
    fn any_text_is_a_list_of_directives() {
        let text = "stray #a 1 \"two\" !three!\n#B /* c */ 4 \"open\n#shape_sphere !open";
        let all: Vec<Statement> = Statements::new(text.as_bytes()).collect();
        let of = |number: usize| {
            let statement = &all[number];
            (slice(text.as_bytes(), statement.word), statement.count, statement.open.is_some())
        };
        assert_eq!(all.len(), 3);
        assert_eq!(
            [of(0), of(1), of(2)],
            [(&b"#a"[..], 3, false), (b"#B", 1, true), (b"#shape_sphere", 0, true)]
        );
        assert_eq!(all[2].end, text.len());
    }

    #[test]
    fn the_form_is_the_one_that_fits_or_may_come_to_fit() {
        let count = |text: &str, dialect| {
            let statement = Statements::new(text.as_bytes()).next().unwrap();
            let spec = statement.spec(text.as_bytes(), dialect).unwrap();
            statement.form(text.as_bytes(), spec).unwrap().count
        };
        assert_eq!(count("#shape_triangle 0 1 2 3", Dialect::Slides), 4);
        assert_eq!(count("#shape_triangle 0 1 2", Dialect::Slides), 4);
        assert_eq!(count("#shape_triangle 0 1 2 3 4", Dialect::Slides), 25);
        assert_eq!(count("#Ambient 1 2 3 4 5", Dialect::Slides), 3);
        assert_eq!(count("#sphere -m red -- 0 0 0 1", Dialect::Hmc), 4);
    }

    #[test]
    fn words_of_other_dialects_are_known() {
        let text = b"#joint_begin elbow";
        let spec = Statements::new(text).next().unwrap().spec(text, Dialect::Slides).unwrap();
        assert_eq!(spec.directive, Directive::JointBegin);
    }
}
