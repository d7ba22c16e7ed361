//! Bytes to tokens: no allocation, and one pass over what numbers are made of.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::directive;

/// What a token is by its first sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// `#word`
    Directive,
    /// A number or a bare word: which of the two is for the directive to say.
    Word,
    /// `"…"`
    Quoted,
    /// `!…!`
    Text,
}

/// Bytes `start .. end` of the text, closing signs included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// The first byte.
    pub start: usize,
    /// The byte after the last.
    pub end: usize,
}

/// Something that was opened and never closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unterminated {
    /// What was opened.
    pub what: Opened,
    /// The first byte of the opening sign.
    pub start: usize,
}

/// What can be left open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opened {
    /// `"`
    Quote,
    /// `!`
    Text,
    /// `/*`
    Comment,
}

/// Why a word is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFault {
    /// It is something else.
    NoNumber,
    /// `nan` or `inf`.
    NotFinite,
    /// `0x…`
    Hexadecimal,
    /// A decimal number too large for double precision.
    Overflow,
}

/// What [`Lexer::numbers`] met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbers {
    /// How many numbers were read.
    pub count: usize,
    /// The byte after the last of them.
    pub end: usize,
    /// Whether the next directive or the end of the text follows; otherwise something that is no number.
    pub clean: bool,
}

/// White space as C has it.
const BLANK: u8 = 1;
/// What a number may begin with.
const NUMBER_START: u8 = 2;

#[allow(clippy::indexing_slicing, reason = "computed by the compiler")]
static CLASS: [u8; 256] = {
    let mut class = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        class[byte] = match byte as u8 {
            b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c => BLANK,
            b'0'..=b'9' | b'+' | b'-' | b'.' => NUMBER_START,
            _ => 0,
        };
        byte += 1;
    }
    class
};

#[inline(always)]
fn class(byte: u8) -> u8 {
    // An index of one byte into 256 entries is always inside.
    CLASS.get(usize::from(byte)).copied().unwrap_or(0)
}

/// A place in the text that moves on.
#[derive(Clone, Debug)]
pub struct Lexer<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lexer<'a> {
    /// Before the first token, after a byte order mark.
    pub fn new(bytes: &'a [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        // Programs for DOS ended their texts with this sign.
        let bytes = bytes.strip_suffix(b"\x1a").unwrap_or(bytes);
        Self { bytes, at }
    }

    /// Before byte `at`.
    pub fn from(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at: at.min(bytes.len()) }
    }

    /// The next byte's place.
    #[inline]
    pub fn at(&self) -> usize {
        self.at
    }

    /// Goes to byte `at`.
    pub fn go_to(&mut self, at: usize) {
        self.at = at.min(self.bytes.len());
    }

    /// The byte that comes next.
    #[inline]
    pub fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The bytes of a token.
    pub fn text(&self, token: Token) -> &'a [u8] {
        self.bytes.get(token.start..token.end).unwrap_or_default()
    }

    /// The bytes of a quoted name or a `!…!` text without its signs; other tokens whole.
    pub fn inner(&self, token: Token) -> &'a [u8] {
        match token.kind {
            TokenKind::Directive | TokenKind::Word => self.text(token),
            TokenKind::Quoted | TokenKind::Text => {
                self.bytes.get(token.start + 1..token.end - 1).unwrap_or_default()
            }
        }
    }

    /// Goes over white space and comments.
    ///
    /// # Errors
    /// A comment that is not closed; the lexer then stands at the end of the text.
    #[inline]
    pub fn skip_blank(&mut self) -> Result<(), Unterminated> {
        loop {
            match self.peek() {
                Some(byte) if class(byte) == BLANK => self.at += 1,
                Some(b'/') if self.starts_comment() => self.skip_comment()?,
                Some(_) | None => return Ok(()),
            }
        }
    }

    fn starts_comment(&self) -> bool {
        matches!(self.bytes.get(self.at + 1), Some(b'/' | b'*'))
    }

    #[cold]
    fn skip_comment(&mut self) -> Result<(), Unterminated> {
        let start = self.at;
        let rest = self.bytes.get(start + 2..).unwrap_or_default();
        if self.bytes.get(start + 1) == Some(&b'/') {
            let length = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            self.at = start + 2 + length.unwrap_or(rest.len());
            return Ok(());
        }
        match rest.windows(2).position(|pair| pair == b"*/") {
            Some(length) => {
                self.at = start + 2 + length + 2;
                Ok(())
            }
            None => {
                self.at = self.bytes.len();
                Err(Unterminated { what: Opened::Comment, start })
            }
        }
    }

    /// The next token; `None` at the end of the text.
    ///
    /// # Errors
    /// Something that is opened and not closed. The lexer then stands at the end of the line (of the text, for a
    /// comment) and can go on.
    pub fn token(&mut self) -> Result<Option<Token>, Unterminated> {
        self.skip_blank()?;
        let start = self.at;
        let (kind, end) = match self.peek() {
            None => return Ok(None),
            Some(b'"') => (TokenKind::Quoted, self.closing(b'"', Opened::Quote)?),
            Some(b'!') => (TokenKind::Text, self.closing(b'!', Opened::Text)?),
            Some(b'#') => (TokenKind::Directive, self.word_end()),
            Some(_) => (TokenKind::Word, self.word_end()),
        };
        self.at = end;
        Ok(Some(Token { kind, start, end }))
    }

    /// The byte after the word that begins here.
    #[inline]
    pub fn word_end(&self) -> usize {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at + rest.iter().position(|&byte| class(byte) == BLANK).unwrap_or(rest.len())
    }

    /// The byte after the closing sign. A line that begins with a directive ends the search, so that one forgotten
    /// sign does not swallow half the file.
    fn closing(&mut self, sign: u8, what: Opened) -> Result<usize, Unterminated> {
        let start = self.at;
        let mut at = start + 1;
        let mut line_end = None;
        while let Some(&byte) = self.bytes.get(at) {
            if byte == sign {
                return Ok(at + 1);
            }
            if byte == b'\n' {
                line_end = line_end.or(Some(at));
                if self.is_directive_line(at + 1) {
                    break;
                }
            }
            at += 1;
        }
        self.at = line_end.unwrap_or(at);
        Err(Unterminated { what, start })
    }

    fn is_directive_line(&self, line: usize) -> bool {
        let rest = self.bytes.get(line..).unwrap_or_default();
        // Deep indentation is looked at only so far, which keeps a text of many blanks linear.
        let indentation = rest.iter().take(64).take_while(|&&byte| byte == b' ' || byte == b'\t').count();
        let lexer = Lexer::from(self.bytes, line + indentation);
        let word = self.bytes.get(lexer.at..lexer.word_end_within(32)).unwrap_or_default();
        word.first() == Some(&b'#') && directive::find_in_any_dialect(word).is_some()
    }

    fn word_end_within(&self, limit: usize) -> usize {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        self.at + rest.iter().take(limit).take_while(|&&byte| class(byte) != BLANK).count()
    }

    /// Reads numbers into `out` as long as nothing else comes: the fast path of all directives whose arguments are
    /// numbers. What else may come is for [`Lexer::token`] to find out.
    #[inline]
    pub fn numbers(&mut self, out: &mut [f64]) -> Numbers {
        let mut numbers = Numbers { count: 0, end: self.at, clean: false };
        for place in out {
            let Some(end) = self.number_into(place) else { break };
            numbers.end = end;
            numbers.count += 1;
        }
        numbers.clean = self.skip_blank().is_ok() && matches!(self.peek(), None | Some(b'#'));
        numbers
    }

    #[inline(always)]
    fn number_into(&mut self, place: &mut f64) -> Option<usize> {
        let before = self.at;
        if self.skip_blank().is_err() {
            self.at = before;
            return None;
        }
        let rest = self.bytes.get(self.at..)?;
        if class(*rest.first()?) != NUMBER_START {
            return None;
        }
        let (value, length) = fast_float2::parse_partial::<f64, _>(rest).ok()?;
        let ends = rest.get(length).is_none_or(|&byte| class(byte) == BLANK);
        if !ends || !value.is_finite() {
            return None;
        }
        *place = value;
        self.at += length;
        Some(self.at)
    }
}

/// The value of a whole word.
///
/// # Errors
/// Why it is no finite decimal number.
pub fn number(word: &[u8]) -> Result<f64, NumberFault> {
    let digits = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
    let is_named =
        |name: &[u8]| digits.get(..name.len()).is_some_and(|start| start.eq_ignore_ascii_case(name));
    if is_named(b"0x") {
        return Err(NumberFault::Hexadecimal);
    }
    match fast_float2::parse_partial::<f64, _>(word) {
        Ok((value, length)) if length == word.len() => match value.is_finite() {
            true => Ok(value),
            false if is_named(b"inf") || is_named(b"nan") => Err(NumberFault::NotFinite),
            false => Err(NumberFault::Overflow),
        },
        Ok(_) | Err(_) if is_named(b"nan(") => Err(NumberFault::NotFinite),
        Ok(_) | Err(_) => Err(NumberFault::NoNumber),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<(TokenKind, &str)> {
        let mut lexer = Lexer::new(text.as_bytes());
        let mut all = Vec::new();
        while let Some(token) = lexer.token().unwrap() {
            all.push((token.kind, &text[token.start..token.end]));
        }
        all
    }

    #[test]
    fn signs_and_blanks_part_tokens() {
        let text =
            "\u{feff}#a -1\r\n\t.5e3 \"two words\" !free // text! x/y // gone #b\n/* gone\n*/ #c!d /\n!!";
        let expected = [
            (TokenKind::Directive, "#a"),
            (TokenKind::Word, "-1"),
            (TokenKind::Word, ".5e3"),
            (TokenKind::Quoted, "\"two words\""),
            (TokenKind::Text, "!free // text!"),
            (TokenKind::Word, "x/y"),
            (TokenKind::Directive, "#c!d"),
            (TokenKind::Word, "/"),
            (TokenKind::Text, "!!"),
        ];
        assert_eq!(tokens(text), expected);
    }

    #[test]
    fn the_end_sign_of_dos_ends_a_text() {
        assert_eq!(tokens("#a 1\r\n\x1a"), [(TokenKind::Directive, "#a"), (TokenKind::Word, "1")]);
        assert_eq!(tokens("1\x1a 2"), [(TokenKind::Word, "1\x1a"), (TokenKind::Word, "2")]);
    }

    #[test]
    fn what_is_not_closed_is_told_where_it_opens() {
        let cases = [
            ("1 \"abc", Opened::Quote, 2, 6),
            ("1 !abc\n def", Opened::Text, 2, 6),
            ("!a\n  b\n #Camera !", Opened::Text, 0, 2),
            (" /* a *", Opened::Comment, 1, 7),
            ("!", Opened::Text, 0, 1),
        ];
        for (text, what, start, goes_on_at) in cases {
            assert_eq!(first_fault(text), (Unterminated { what, start }, goes_on_at), "{text}");
        }
    }

    fn first_fault(text: &str) -> (Unterminated, usize) {
        let mut lexer = Lexer::new(text.as_bytes());
        loop {
            if let Err(fault) = lexer.token() {
                return (fault, lexer.at());
            }
        }
    }

    #[test]
    fn numbers_are_those_of_c_and_finite() {
        for (word, value) in [
            ("0", 0.0),
            (".523", 0.523),
            ("-1", -1.0),
            ("+2.", 2.0),
            ("1e-3", 1e-3),
            ("1.E+2", 100.0),
            ("-0.89850075E-01", -0.089850075),
            ("1e-400", 0.0),
        ] {
            assert_eq!(number(word.as_bytes()), Ok(value), "{word}");
            let mut out = [f64::NAN; 2];
            let numbers = Lexer::new(word.as_bytes()).numbers(&mut out);
            assert_eq!((numbers.count, numbers.end, numbers.clean), (1, word.len(), true), "{word}");
            assert_eq!(out[0], value, "{word}");
        }
        for (word, fault) in [
            ("", NumberFault::NoNumber),
            (".", NumberFault::NoNumber),
            ("-", NumberFault::NoNumber),
            ("1e", NumberFault::NoNumber),
            ("1s.0", NumberFault::NoNumber),
            ("0.5.0", NumberFault::NoNumber),
            ("1,5", NumberFault::NoNumber),
            ("--1", NumberFault::NoNumber),
            ("infrared", NumberFault::NoNumber),
            ("nan", NumberFault::NotFinite),
            ("-Inf", NumberFault::NotFinite),
            ("+infinity", NumberFault::NotFinite),
            ("nan(1)", NumberFault::NotFinite),
            ("0x10", NumberFault::Hexadecimal),
            ("-0X1p3", NumberFault::Hexadecimal),
            ("1e400", NumberFault::Overflow),
            ("-1e999999999999999999999", NumberFault::Overflow),
        ] {
            assert_eq!(number(word.as_bytes()), Err(fault), "{word}");
            let mut out = [f64::NAN; 2];
            let numbers = Lexer::new(word.as_bytes()).numbers(&mut out);
            assert_eq!((numbers.count, numbers.clean), (0, word.is_empty()), "{word}");
        }
    }

    #[test]
    fn runs_of_numbers_stop_at_what_is_none() {
        let run = |text: &str| {
            let mut out = [0.0; 3];
            let numbers = Lexer::new(text.as_bytes()).numbers(&mut out);
            (numbers.count, numbers.end, numbers.clean)
        };
        assert_eq!(run("1 2#"), (1, 1, false));
        assert_eq!(run("1 2 #x"), (2, 3, true));
        assert_eq!(run("1 /* a */ 2\n// b\n#x"), (2, 11, true));
        assert_eq!(run("1 2 3 4"), (3, 5, false));
        assert_eq!(run("1 two"), (1, 1, false));
        assert_eq!(run("1 /*"), (1, 1, false));
        assert_eq!(run(""), (0, 0, true));
    }
}
