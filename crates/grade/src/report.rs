//! Reports: for a terminal, for programs, for a browser.

pub mod text;

pub mod json;

pub mod junit;

pub mod html;

use crate::grade::Outcome;
use crate::suite::Suite;
use crate::suite::Test;

/// A suite and what came of it.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// The suite.
    pub suite: &'a Suite,
    /// What came of it, in the suite's order.
    pub outcomes: &'a [Outcome],
    /// What was graded: the command as typed.
    pub program: &'a str,
    /// Seconds that the whole took.
    pub seconds: f64,
}

impl<'a> Report<'a> {
    /// The points that were reached.
    pub fn points(&self) -> f64 {
        self.outcomes.iter().map(|outcome| outcome.points).sum()
    }

    /// Each test that was run, with its outcome.
    pub fn rows(&self) -> impl Iterator<Item = (&'a Test, &'a Outcome)> {
        let tests = &self.suite.tests;
        self.outcomes.iter().filter_map(|outcome| Some((tests.get(outcome.number)?, outcome)))
    }

    /// True if every test has all its points.
    pub fn is_perfect(&self) -> bool {
        self.outcomes.len() == self.suite.tests.len()
            && self.rows().all(|(test, outcome)| outcome.points >= test.points)
    }
}

/// Points with as many decimals as they need, at most two.
fn points(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What is told to whoever made the program, what helps most first, one sentence a line.
fn told(test: &Test, outcome: &Outcome) -> Vec<String> {
    let mut lines: Vec<String> =
        outcome.hints.iter().map(|hint| format!("Likely fault: {}", hint.text)).collect();
    lines.extend(outcome.reasons.iter().cloned());
    if let (Some(advice), true) = (&test.advice, outcome.points < test.points) {
        lines.push(advice.clone());
    }
    lines
}

/// Text between tags or in quotes of XML and HTML.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            c => escaped.push(c),
        }
    }
    escaped
}
