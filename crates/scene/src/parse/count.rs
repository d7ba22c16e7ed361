//! Too few arguments: which of them is missing, as far as the way they are laid out tells.

use super::Call;
use super::Parser;
use super::arguments::takes;
use super::arguments::takes_count;
use crate::diagnostic::Diagnostic;
use crate::directive::ArgumentKind;
use crate::directive::Form;
use crate::lex::Token;
use crate::lex::TokenKind;
use crate::span::Span;

impl Parser<'_> {
    /// The error of a directive with too few arguments. `at_word` is its word.
    pub(super) fn missing(&self, form: &Form, at_word: Span) -> Diagnostic {
        let Call { spec, count, .. } = self.call;
        let given = takes(spec.word, &takes_count(form), count);
        if let Some((span, names)) = self.short_group(form) {
            let (few, list) = (form.count - count, names.join(" "));
            let what = if few == 1 { "one".to_owned() } else { few.to_string() };
            let is = if few == 1 { "is" } else { "are" };
            let message = format!("{given}: {what} of `{list}` {is} missing");
            return Diagnostic::error("argument-count", message)
                .at(span)
                .label(format!("`{list}` belong here"));
        }
        let names = self.missing_names(form);
        let list = match names.as_slice() {
            [one] => format!("`{one}` is missing"),
            [first, .., last] if names.len() > 4 => {
                format!("{} are missing, from `{first}` to `{last}`", names.len())
            }
            [all @ .., last] => format!("`{}` and `{last}` are missing", all.join("`, `")),
            [] => String::new(),
        };
        Diagnostic::error("argument-count", format!("{given}: {list}")).at(at_word).label(list)
    }

    /// The last names; where the text that ends a material is there, the numbers before it.
    fn missing_names(&self, form: &Form) -> Vec<&'static str> {
        let names: Vec<_> = form.each().collect();
        let has_text = self.tokens.last().is_some_and(|token| token.kind == TokenKind::Text);
        let given = self.call.count - usize::from(wants_text(form) && has_text);
        let missing = form.count - self.call.count;
        names.into_iter().skip(given).take(missing).map(|(name, _)| name).collect()
    }

    /// Where the arguments stand in groups, by line ends or wider gaps, and only one group is too small: its place and
    /// the names that belong there.
    fn short_group(&self, form: &Form) -> Option<(Span, Vec<&'static str>)> {
        let mut groups: Vec<&[Token]> = Vec::new();
        let mut rest = self.tokens.as_slice();
        while !rest.is_empty() {
            let length = rest.windows(2).position(|pair| self.is_apart(pair)).map_or(rest.len(), |at| at + 1);
            let (group, after) = rest.split_at(length);
            groups.push(group);
            rest = after;
        }
        let starts = form.group_starts();
        let ends = starts.iter().skip(1).copied().chain([form.count]);
        let wanted: Vec<_> = starts.iter().copied().zip(ends).collect();
        let is_text = |token: Option<&Token>| token.is_some_and(|token| token.kind == TokenKind::Text);
        // Where the text is missing, no layout can say it better.
        if wants_text(form) && !is_text(self.tokens.last()) {
            return None;
        }
        // One group alone says nothing: there the last one is as likely missing as the first.
        if groups.len() != wanted.len() || groups.len() < 2 {
            return None;
        }
        let mut short = groups.iter().zip(&wanted).filter(|(group, (start, end))| group.len() != end - start);
        let (group, &(start, end)) = short.next()?;
        if short.next().is_some() || group.len() >= end - start {
            return None;
        }
        let (first, last) = (group.first()?, group.last()?);
        let names = form.each().skip(start).take(end - start).map(|(name, _)| name).collect();
        Some((self.span(first.start, last.end), names))
    }

    /// Whether more than one blank stands between two neighbours.
    fn is_apart(&self, pair: &[Token]) -> bool {
        let &[before, after] = pair else { return false };
        let gap = self.bytes.get(before.end..after.start).unwrap_or_default();
        gap.len() > 1 || gap.contains(&b'\n') || gap.contains(&b'\t')
    }
}

fn wants_text(form: &Form) -> bool {
    form.each().last().is_some_and(|(_, group)| group.kind == ArgumentKind::Text)
}
