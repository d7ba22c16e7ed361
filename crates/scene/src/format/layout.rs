//! Pieces to lines.

use super::WIDTH;
use super::canonical_word;
use super::pieces::Piece;
use super::pieces::PieceKind;
use crate::directive;
use crate::directive::Directive;
use crate::sources::characters;

/// Deeper groups are indented no further, or the text of deep nesting would grow with its square.
const DEEPEST: usize = 32;

/// The text so far.
pub struct Printer<'a> {
    text: &'a [u8],
    out: Vec<u8>,
    depth: usize,
    /// Whether an empty line would come at the begin of the file or of a group.
    at_begin: bool,
}

/// How the arguments of a directive belong together.
struct Groups {
    /// The places of the first of each group.
    starts: Vec<usize>,
    /// What parts two groups on one line.
    gap: &'static [u8],
    /// Whether each group that does not fit takes a line of its own.
    in_rows: bool,
}

impl<'a> Printer<'a> {
    /// Nothing printed yet.
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, out: Vec::with_capacity(text.len() + text.len() / 8), depth: 0, at_begin: true }
    }

    /// The whole text.
    pub fn finish(self) -> Vec<u8> {
        self.out
    }

    /// A directive, its arguments, and the comments up to the next directive; before the first directive comments only.
    pub fn statement(&mut self, pieces: &[Piece]) {
        let last = pieces.iter().rposition(|piece| !piece.kind.is_comment());
        let (directive, comments) = pieces.split_at(last.map_or(0, |last| last + 1));
        if let [word, arguments @ ..] = directive {
            self.directive(word, arguments);
        }
        let mut on_line = !directive.is_empty();
        for comment in comments {
            if on_line && comment.breaks == 0 {
                self.put(b"  ");
            } else {
                if on_line {
                    self.put(b"\n");
                }
                self.begin_line(comment.breaks, self.depth);
            }
            self.comment(comment);
            self.at_begin &= on_line && comment.breaks == 0;
            on_line = true;
        }
        if on_line {
            self.put(b"\n");
        }
    }

    fn directive(&mut self, word: &Piece, arguments: &[Piece]) {
        let name = canonical_word(word.text(self.text));
        let (opens, closes) = (name.ends_with(b"_begin"), name.ends_with(b"_end"));
        if closes {
            self.depth = self.depth.saturating_sub(1);
            self.at_begin = true;
        }
        self.begin_line(word.breaks, self.depth);
        self.at_begin = opens;
        let count = arguments.iter().filter(|piece| !piece.kind.is_comment()).count();
        let groups = Groups::of(name, count);
        self.put(name);
        if arguments.iter().any(|piece| piece.kind.is_comment()) {
            self.commented(&groups, arguments);
        } else {
            self.plain(name, &groups, arguments);
        }
        self.depth += usize::from(opens);
    }

    /// Arguments without comments: on one line where they fit.
    fn plain(&mut self, name: &[u8], groups: &Groups, arguments: &[Piece]) {
        let mut column = indentation(self.depth) + name.len();
        let gaps = groups.starts.len().saturating_sub(1) * (groups.gap.len() - 1);
        let whole: usize = arguments.iter().map(|piece| 1 + characters(piece.text(self.text))).sum();
        let fits = column + whole + gaps <= WIDTH;
        let ends = groups.starts.iter().skip(1).copied().chain([arguments.len()]);
        for (place, (start, end)) in groups.starts.iter().copied().zip(ends).enumerate() {
            let group = arguments.get(start..end).unwrap_or_default();
            let width: usize = group.iter().map(|piece| 1 + characters(piece.text(self.text))).sum();
            let gap = if place == 0 { b" " } else { groups.gap };
            let breaks = !fits && (groups.in_rows || column + gap.len() - 1 + width > WIDTH);
            // A line that holds the word alone would gain nothing.
            if breaks && (place > 0 || groups.in_rows) {
                self.put(b"\n");
                self.indent(self.depth + 1);
                column = indentation(self.depth + 1) + width - 1;
            } else {
                self.put(gap);
                column += gap.len() - 1 + width;
            }
            for (place, argument) in group.iter().enumerate() {
                self.put(if place == 0 { b"" } else { b" " });
                self.put(argument.text(self.text));
            }
        }
    }

    /// Arguments with comments between them: each group on a line of its own.
    fn commented(&mut self, groups: &Groups, arguments: &[Piece]) {
        let mut place = 0;
        // Whether the line can take no argument any more, or one without a new line.
        let (mut closed, mut opened) = (false, false);
        for (at, piece) in arguments.iter().enumerate() {
            let next = arguments.get(at + 1);
            let leads = piece.kind == PieceKind::BlockComment
                && next.is_some_and(|next| next.breaks == 0 && !next.kind.is_comment());
            let is_comment = piece.kind.is_comment();
            let begins_group = groups.starts.binary_search(&place).is_ok();
            let new_line = match (is_comment, leads) {
                (true, false) => piece.breaks > 0,
                (true, true) | (false, _) => !opened && (closed || begins_group),
            };
            if new_line {
                self.put(b"\n");
                self.indent(self.depth + 1);
            } else {
                self.put(if is_comment && !leads { b"  " } else { b" " });
            }
            if is_comment {
                self.comment(piece);
            } else {
                self.put(piece.text(self.text));
                place += 1;
            }
            closed = is_comment && !leads;
            opened = leads;
        }
    }

    /// The begin of a line, after an empty one where the text has some.
    fn begin_line(&mut self, breaks: usize, depth: usize) {
        if breaks > 1 && !self.at_begin {
            self.put(b"\n");
        }
        self.indent(depth);
    }

    fn indent(&mut self, depth: usize) {
        self.out.resize(self.out.len() + indentation(depth), b' ');
    }

    fn comment(&mut self, comment: &Piece) {
        for (number, line) in comment_lines(comment.text(self.text)).enumerate() {
            self.put(if number == 0 { b"" } else { b"\n" });
            self.put(line);
        }
    }

    fn put(&mut self, bytes: &[u8]) {
        self.out.extend_from_slice(bytes);
    }
}

fn indentation(depth: usize) -> usize {
    2 * depth.min(DEEPEST)
}

/// The lines of a comment without the blanks at their ends.
pub fn comment_lines(comment: &[u8]) -> impl Iterator<Item = &[u8]> {
    comment.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end)
}

impl Groups {
    fn of(name: &[u8], count: usize) -> Self {
        let spec = directive::find(name);
        let Some((spec, form)) = spec.and_then(|spec| Some((spec, spec.form(count)?))) else {
            return Self { starts: (0..count).collect(), gap: b" ", in_rows: false };
        };
        let in_rows = spec.directive == Directive::GroupBegin;
        Self { starts: form.group_starts(), gap: b"  ", in_rows }
    }
}
