//! What stands at a place of a text.

use crate::statement::Statement;
use crate::statement::Statements;
use dotray_scene::lex::Opened;
use dotray_scene::lex::Token;

/// What the cursor is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// Nothing that belongs to a directive.
    Nothing,
    /// A comment.
    Comment,
    /// A directive's word.
    Word,
    /// The argument of this number, flags counted.
    Argument(usize),
    /// A blank where the argument of this number belongs.
    Gap(usize),
    /// A `!…!` or `"…"` that is not closed: what it is and where it begins.
    Open(Opened, usize),
}

/// A place of a text.
#[derive(Clone, Debug)]
pub struct Spot {
    /// The byte.
    pub at: usize,
    /// The directive that begins at or before it.
    pub statement: Option<Statement>,
    /// What is there.
    pub on: On,
}

impl Spot {
    /// What stands at byte `at`; a word's end belongs to the word.
    pub fn new(bytes: &[u8], at: usize) -> Self {
        let mut found = None;
        for statement in Statements::new(bytes) {
            if statement.word.start > at {
                break;
            }
            found = Some(statement);
        }
        let on = match &found {
            Some(statement) => on(bytes, statement, at),
            None if in_comment(bytes, 0, at) => On::Comment,
            None => On::Nothing,
        };
        Self { at, statement: found, on }
    }

    /// The token that the cursor is on.
    pub fn token(&self) -> Option<Token> {
        let statement = self.statement.as_ref()?;
        match self.on {
            On::Word => Some(statement.word),
            On::Argument(index) => statement.arguments.get(index).copied(),
            On::Nothing | On::Comment | On::Gap(_) | On::Open(..) => None,
        }
    }
}

fn on(bytes: &[u8], statement: &Statement, at: usize) -> On {
    let covers = |token: &Token| (token.start..=token.end).contains(&at);
    if covers(&statement.word) {
        return On::Word;
    }
    if let Some(index) = statement.arguments.iter().position(covers) {
        return On::Argument(index);
    }
    let gone = statement.arguments.iter().take_while(|token| token.end < at).count();
    let last = gone.checked_sub(1).and_then(|last| statement.arguments.get(last));
    let before = last.unwrap_or(&statement.word).end;
    if let Some(open) = statement.open.filter(|open| open.start < at && at <= statement.end) {
        match open.what {
            Opened::Comment => return On::Comment,
            // Further words of the line may have been read already.
            Opened::Text | Opened::Quote if before <= open.start => return On::Open(open.what, open.start),
            Opened::Text | Opened::Quote => {}
        }
    }
    match in_comment(bytes, before, at) {
        true => On::Comment,
        false => On::Gap(gone),
    }
}

/// Whether byte `at` lies in a comment, where between `from` and it there are only blanks and comments.
fn in_comment(bytes: &[u8], from: usize, at: usize) -> bool {
    let mut rest = from;
    while rest < at {
        let here = bytes.get(rest..).unwrap_or_default();
        let end = if here.starts_with(b"//") {
            let length = here.iter().position(|byte| b"\r\n".contains(byte)).unwrap_or(here.len());
            // A comment goes on until the line ends.
            if at <= rest + length {
                return at > rest;
            }
            rest + length
        } else if here.starts_with(b"/*") {
            let inside = here.get(2..).unwrap_or_default();
            let length = inside.windows(2).position(|pair| pair == b"*/").map_or(here.len(), |at| at + 4);
            if at < rest + length {
                return at > rest;
            }
            rest + length
        } else {
            rest + 1
        };
        rest = end;
    }
    false
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// What is at the sign `|`.
    fn at(text: &str) -> On {
        let place = text.find('|').unwrap();
        Spot::new(text.replacen('|', "", 1).as_bytes(), place).on
    }

    #[test]
    fn each_place_is_known() {
        let cases = [
            ("|", On::Nothing),
            ("stray| #ambient", On::Nothing),
            ("// a| b\n#ambient", On::Comment),
            ("|#ambient 1", On::Word),
            ("#amb|ient 1", On::Word),
            ("#ambient| 1", On::Word),
            ("#ambient | 1", On::Gap(0)),
            ("#ambient 1 .|5 1", On::Argument(1)),
            ("#ambient 1 .5 1|", On::Argument(2)),
            ("#ambient 1 .5 1\n|\n#ambient", On::Gap(3)),
            ("#ambient 1 // x|\n .5", On::Comment),
            ("#ambient 1 // x\n| .5", On::Gap(1)),
            ("#ambient 1 /* x| */ .5", On::Comment),
            ("#ambient 1 /* x */| .5", On::Gap(1)),
            ("#ambient 1 /* x|", On::Comment),
            ("#material 1 !wo|od!", On::Argument(1)),
            ("#material 1 !wo|od\n#ambient 1", On::Open(Opened::Text, 12)),
            ("#texture \"a b|\n#ambient 1", On::Open(Opened::Quote, 9)),
        ];
        for (text, expected) in cases {
            assert_eq!(at(text), expected, "{text}");
        }
    }

    #[test]
    fn no_place_of_any_text_is_too_much() {
        let text = "\u{feff}#a !\u{1d11e} \"x /* // ! \" */ #b!#c\n#d \"\n!\r\n/* \u{e4}";
        for cut in 0..=text.len() {
            for place in 0..=cut + 1 {
                Spot::new(text.as_bytes().get(..cut).unwrap(), place);
            }
        }
    }
}
