//! Arguments looked at one by one: which is missing, which is too many, which is of the wrong kind.

use super::Call;
use super::Parser;
use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::directive::ArgumentKind;
use crate::directive::Arguments;
use crate::directive::Directive;
use crate::directive::Form;
use crate::directive::Spec;
use crate::directive::find_in;
use crate::lex;
use crate::lex::Lexer;
use crate::lex::NumberFault;
use crate::lex::Opened;
use crate::lex::Token;
use crate::lex::TokenKind;
use crate::lex::Unterminated;
use crate::span::Span;

/// More tokens of one directive than this are counted, not kept.
const KEPT: usize = 64;

/// A word of the file as a message may show it: short, on one line, in backquotes.
pub(super) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(word.get(..word.len().min(4 * LONGEST)).unwrap_or_default());
    let mut short: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    format!("`{short}`")
}

/// "`#word` takes 3 arguments, but 1 is given"
pub(super) fn takes(word: &str, takes: &str, given: usize) -> String {
    let arguments = if takes == "1" { "argument" } else { "arguments" };
    let is = if given == 1 { "is" } else { "are" };
    format!("`{word}` takes {takes} {arguments}, but {given} {is} given")
}

impl Parser<'_> {
    /// Reads the arguments token by token and tells all that is wrong with them; true where nothing is.
    #[cold]
    pub(super) fn look_closely(&mut self, spec: &'static Spec, start: usize) -> bool {
        let after_word = self.lexer.at();
        let (count, closed) = self.collect();
        let end = self.tokens.last().map_or(after_word, |token| token.end);
        self.call = Call { spec, start, end, count, word: None, skip: self.named.flag_tokens };
        if !closed {
            // The count would only be wrong because of what was left open.
            return false;
        }
        let Some(form) = spec.form(count) else {
            self.wrong_count(after_word);
            return false;
        };
        let mut good = true;
        for (place, (name, group)) in form.each().enumerate() {
            good &= self.one_argument(place, name, group);
        }
        good
    }

    /// Keeps the tokens up to the next directive and says how many there are, and whether all were closed.
    fn collect(&mut self) -> (usize, bool) {
        self.tokens.clear();
        let mut count = 0;
        let mut closed = true;
        loop {
            match self.lexer.skip_blank() {
                Ok(()) if matches!(self.lexer.peek(), None | Some(b'#')) => return (count, closed),
                Ok(()) => {}
                Err(fault) => {
                    self.unterminated(fault);
                    closed = false;
                    continue;
                }
            }
            match self.lexer.token() {
                Ok(Some(token)) => {
                    count += 1;
                    if self.tokens.len() < KEPT {
                        self.tokens.push(token);
                    }
                }
                Ok(None) => return (count, closed),
                Err(fault) => {
                    self.unterminated(fault);
                    closed = false;
                }
            }
        }
    }

    /// Skips to the next directive; only what is left open is told.
    pub(super) fn skip_arguments(&mut self) {
        let _ = self.collect();
    }

    fn one_argument(&mut self, place: usize, name: &str, group: &Arguments) -> bool {
        let Some(token) = self.tokens.get(place).copied() else { return false };
        let text = self.lexer.text(token);
        let fits = match group.kind {
            ArgumentKind::Number | ArgumentKind::Integer => match lex::number(text) {
                Ok(value) if token.kind == TokenKind::Word => {
                    if let Some(slot) = self.values.get_mut(place) {
                        *slot = value;
                    }
                    true
                }
                Ok(_) => return self.no_number(token, name, NumberFault::NoNumber),
                Err(fault) => return self.no_number(token, name, fault),
            },
            ArgumentKind::Name => matches!(token.kind, TokenKind::Word | TokenKind::Quoted),
            // Some courses' programs read one word here, whatever its signs.
            ArgumentKind::Text => token.kind == TokenKind::Text || self.conventions.lenient,
        };
        if matches!(group.kind, ArgumentKind::Name | ArgumentKind::Text) {
            self.call.word = Some(token);
        }
        if !fits {
            let (wanted, label) = match group.kind {
                ArgumentKind::Text => {
                    ("a text between exclamation marks", "write `!…!`; `!!` is an empty text")
                }
                ArgumentKind::Name | ArgumentKind::Number | ArgumentKind::Integer => {
                    ("a file name", "write the name as it is or in \"quotes\"")
                }
            };
            let message = format!("`{name}` of `{}` is {wanted}, not {}", self.call.spec.word, shown(text));
            let span = self.span(token.start, token.end);
            self.sink.error(Diagnostic::error("wrong-argument", message).at(span).label(label));
        }
        fits
    }

    fn no_number(&mut self, token: Token, name: &str, fault: NumberFault) -> bool {
        let text = self.lexer.text(token);
        let message = format!("`{name}` of `{}` must be a number, not {}", self.call.spec.word, shown(text));
        let error = Diagnostic::error("not-a-number", message).at(self.span(token.start, token.end));
        let error = self.with_directive(error, token.start);
        let has = |sign: &[u8]| text.windows(sign.len()).any(|window| window == sign);
        self.sink.error(match fault {
            NumberFault::NotFinite => error.label("infinity and NaN are not allowed"),
            NumberFault::Hexadecimal => error.label("write it in decimal"),
            NumberFault::Overflow => error.label("too large for double precision"),
            NumberFault::NoNumber if token.kind != TokenKind::Word => {
                error.label("expected a decimal number")
            }
            NumberFault::NoNumber if has(b"//") || has(b"/*") => {
                error.label("expected a decimal number").help("put a blank before the comment")
            }
            NumberFault::NoNumber if has(b"#") => {
                error.label("expected a decimal number").help("put a blank before the `#`")
            }
            NumberFault::NoNumber if has(b"!") => {
                error.label("expected a decimal number").help("put a blank before the `!`")
            }
            NumberFault::NoNumber if has(b",") => error
                .label("expected a decimal number")
                .help("numbers are parted by blanks; the decimal sign is `.`"),
            NumberFault::NoNumber
                if text.strip_suffix(b"f").is_some_and(|rest| lex::number(rest).is_ok()) =>
            {
                error.label("expected a decimal number").help("leave out the `f` at its end")
            }
            NumberFault::NoNumber => error.label("expected a decimal number"),
        });
        false
    }

    fn wrong_count(&mut self, after_word: usize) {
        let Call { spec, start, count, .. } = self.call;
        let word = spec.word;
        let at_word = self.span(start, after_word);
        if spec.directive == Directive::Material && count == 18 && self.dialect != Dialect::Hmc {
            self.half_converted(at_word);
        } else if let [form] = spec.forms {
            let error =
                if count < form.count { self.missing(form, at_word) } else { self.surplus(form, at_word) };
            let error = error.note(usage(word, form));
            let other = match (spec.directive, count) {
                (Directive::Material, 19) => Some("`uva` and `jhu`"),
                (Directive::Material, 17) => Some("`slides` and `unisa`"),
                _other => None,
            };
            let read = self.dialect;
            self.sink.error(match other {
                Some(dialects) => error.help(format!(
                    "a material of {count} arguments belongs to the dialects {dialects}; the file is read as `{read}`"
                )),
                None => error,
            });
        } else {
            let counts: Vec<String> = spec.forms.iter().map(|form| form.count.to_string()).collect();
            let message = takes(word, &counts.join(" or "), count);
            let error =
                Diagnostic::error("argument-count", message).at(at_word).label(format!("{count} given"));
            self.sink.error(spec.forms.iter().fold(error, |error, form| error.note(usage(word, form))));
        }
        self.first_faulty_token();
    }

    /// A material between those of two dialects: which of them is meant nobody can say.
    fn half_converted(&mut self, at_word: Span) {
        let message = "`#material` takes 17 arguments, in the dialects `uva` and `jhu` 19, but 18 are given";
        let ends_in_text = self.tokens.get(17).is_some_and(|token| token.kind == TokenKind::Text);
        let label = if ends_in_text { "one too many, or one too few" } else { "perhaps its `!!` is missing" };
        let error = Diagnostic::error("argument-count", message).at(at_word).label(label);
        let usages = [Dialect::Slides, Dialect::Uva].into_iter().filter_map(|dialect| {
            let form = find_in(dialect, b"#material")?.forms.first()?;
            Some(format!("in `{dialect}` {}", usage("#material", form)))
        });
        self.sink.error(usages.fold(error, Diagnostic::note));
    }

    fn surplus(&self, form: &Form, at_word: Span) -> Diagnostic {
        let Call { spec, count, .. } = self.call;
        let error = Diagnostic::error("argument-count", takes(spec.word, &takes_count(form), count));
        let Some(token) = self.tokens.get(form.count) else { return error.at(at_word) };
        let label = if count == form.count + 1 { "one too many" } else { "the first one too many" };
        self.with_directive(error.at(self.span(token.start, token.end)).label(label), token.start)
    }

    /// Says where the directive at hand stands, for a fault on another line.
    fn with_directive(&self, error: Diagnostic, place: usize) -> Diagnostic {
        let start = self.call.start;
        let between = self.bytes.get(start..place).unwrap_or_default();
        if !between.contains(&b'\n') {
            return error;
        }
        error.note_at(self.span(start, start + self.call.spec.word.len()), "the directive stands here")
    }

    /// Where the count is wrong, a word among the numbers is a second fault worth telling.
    fn first_faulty_token(&mut self) {
        let Some(form) = self.call.spec.forms.first() else { return };
        for (place, (name, group)) in form.each().enumerate() {
            let Some(token) = self.tokens.get(place).copied() else { return };
            if matches!(group.kind, ArgumentKind::Number | ArgumentKind::Integer)
                && token.kind == TokenKind::Word
                && let Err(fault) = lex::number(self.lexer.text(token))
            {
                self.no_number(token, name, fault);
                return;
            }
        }
    }

    #[cold]
    pub(super) fn stray_text(&mut self) {
        let start = self.lexer.at();
        let (count, closed) = self.collect();
        let Some(first) = self.tokens.first().copied() else { return };
        if !closed {
            return;
        }
        let end = self.tokens.last().map_or(first.end, |token| token.end);
        if self.dialect == Dialect::Hmc {
            // As that course's program, which looks for `#version` first.
            let span = self.span(start, end);
            let message = "the text before `#version` is passed over";
            return self.sink.warn("ignored-part", || Diagnostic::warning("ignored-part", message).at(span));
        }
        let error = Diagnostic::error(
            "stray-text",
            format!("{} before the first directive", shown(self.lexer.text(first))),
        );
        let error = error.at(self.span(start, end)).label("belongs to no directive");
        self.sink.error(if count > 1 { error.help("a comment begins with `//`") } else { error });
    }

    #[cold]
    pub(super) fn unterminated(&mut self, fault: Unterminated) {
        let (length, message, label) = match fault.what {
            Opened::Quote => (1, "the quoted name is never closed", "its second `\"` is missing"),
            Opened::Text => (1, "the text is never closed", "its second `!` is missing"),
            Opened::Comment => (2, "the comment is never closed", "its `*/` is missing"),
        };
        self.recognized |= fault.what == Opened::Comment;
        let span = self.span(fault.start, fault.start + length);
        self.sink.error(Diagnostic::error("unterminated", message).at(span).label(label));
    }

    /// Where the arguments `first .. first + count` of the directive at hand stand: lexed again, for only messages ask.
    pub(super) fn arguments_span(&self, first: usize, count: usize) -> Span {
        arguments_span(self.bytes, self.call_span(), self.token_of(first), count)
    }

    /// Which token after the word argument `place` is.
    pub(super) fn token_of(&self, place: usize) -> usize {
        usize::try_from(place as i64 + i64::from(self.call.skip)).unwrap_or(0)
    }

    /// The number `place` of the directive at hand.
    pub(super) fn value(&self, place: usize) -> f64 {
        self.values.get(place).copied().unwrap_or(0.0)
    }

    /// Tells an error about one argument.
    pub(super) fn argument_error(&mut self, place: usize, code: &'static str, message: String, label: &str) {
        let span = self.arguments_span(place, 1);
        let place = usize::try_from(span.start).unwrap_or(0);
        self.sink.error(self.with_directive(Diagnostic::error(code, message).at(span).label(label), place));
    }

    /// The name of argument `place` of the directive at hand.
    pub(super) fn argument_name(&self, place: usize) -> &'static str {
        let form = self.call.spec.form(self.call.count);
        form.and_then(|form| form.each().nth(place)).map_or("", |(name, _)| name)
    }

    /// The argument as written, in backquotes.
    pub(super) fn written(&self, place: usize) -> String {
        let span = self.arguments_span(place, 1);
        let range = usize::try_from(span.start).unwrap_or(0)..usize::try_from(span.end).unwrap_or(0);
        shown(self.bytes.get(range).unwrap_or_default())
    }

    /// The argument `place` as a whole number, or an error.
    pub(super) fn whole(&mut self, place: usize) -> Option<i64> {
        const SAFE: f64 = 9_007_199_254_740_992.0;
        let value = self.value(place);
        let whole = value as i64;
        if whole as f64 == value && value.abs() <= SAFE {
            return Some(whole);
        }
        let (word, name, written) = (self.call.spec.word, self.argument_name(place), self.written(place));
        let message = format!("`{name}` of `{word}` must be a whole number, not {written}");
        self.argument_error(place, "not-an-integer", message, "expected a whole number");
        None
    }
}

/// Where arguments of the directive at `call` stand, with the whole directive where they cannot be found.
pub(super) fn arguments_span(bytes: &[u8], call: Span, first: usize, count: usize) -> Span {
    let mut lexer = Lexer::from(bytes, usize::try_from(call.start).unwrap_or(usize::MAX));
    let mut tokens = std::iter::from_fn(|| lexer.token().ok().flatten()).skip(1 + first).take(count);
    let Some(token) = tokens.next() else { return call };
    let end = tokens.last().map_or(token.end, |last| last.end);
    Span::new(call.file, token.start, end)
}

pub(super) fn takes_count(form: &Form) -> String {
    if form.count == 0 { "no".to_owned() } else { form.count.to_string() }
}

fn usage(word: &str, form: &Form) -> String {
    if form.count == 0 {
        format!("it is written `{word}` alone")
    } else {
        format!("it is written `{word} {}`", form.usage())
    }
}
