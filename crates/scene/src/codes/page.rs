//! The page of all messages, and one message at length.

use super::Code;
use super::Example;
use super::Explanation;
use super::all_codes;
use super::code;
use super::explanation;
use crate::diagnostic::Severity;
use std::fmt::Write;

const INTRODUCTION: &str = "\
# Messages

<!-- Made from crates/scene/src/codes; `UPDATE=1 cargo test -p dotray-scene --test messages_page` rewrites it. -->

What dotray says about a scene begins with the place and a code:

```text
scene.ray:4:1: error[unknown-directive]: unknown directive `#shape_spere`
  |
4 | #shape_spere 0  0 0 0  1
  | ^^^^^^^^^^^^ no directive has this name
  |
  = help: did you mean `#shape_sphere`?
```

An error keeps the scene from being rendered, a warning does not. `dotray check FILES…` finds all of them in one run,
`dotray check --explain CODE` prints what stands here about a code.

## For programs

`dotray check --format json` prints one object:

| key | value |
| --- | --- |
| `version` | 1; it changes when a key changes its meaning |
| `files` | how many files were checked |
| `errors`, `warnings` | how many messages of each kind there are |
| `diagnostics` | the messages, in the order of files and places |

A message has these keys; what is not known is `null`:

| key | value |
| --- | --- |
| `severity` | `\"error\"` or `\"warning\"` |
| `code` | one of the codes below |
| `message` | one sentence |
| `file` | the path, `<stdin>` for standard input |
| `line`, `column` | where it begins, from 1, columns in characters; `null` where the whole file is meant |
| `end_line`, `end_column` | the place after the last character |
| `label` | the words under the caret, or `null` |
| `notes` | a list of further sentences, each with `message`, `file`, `line`, `column`, `end_line`, `end_column` |
| `help` | a likely repair, or `null` |

`--format github` prints workflow commands that GitHub shows beside the lines, `--format sarif` a log of SARIF 2.1.0.

## Codes
";

/// The page docs/messages.md, in Markdown.
pub fn messages_page() -> String {
    let mut page = String::from(INTRODUCTION);
    page.push_str("\n| code | | meaning |\n| --- | --- | --- |\n");
    for Code { name, severity, meaning } in all_codes() {
        line(&mut page, &format!("| [`{name}`](#{name}) | {} | {meaning} |", word(severity)));
    }
    for code in all_codes() {
        if let Some(explanation) = explanation(code.name) {
            line(&mut page, &format!("\n### {}\n", code.name));
            wrapped(&mut page, &format!("*{}.* {}", word(code.severity), explanation.text), 110);
            section(&mut page, explanation, "\n```text\n", "```\n");
        }
    }
    page
}

/// One code at length, as plain text; `None` where there is no such code.
pub fn explain(name: &str) -> Option<String> {
    let code = code(name)?;
    let explanation = explanation(name)?;
    let mut text = format!("{}[{name}]: {}\n\n", word(code.severity), code.meaning);
    wrapped(&mut text, explanation.text, 80);
    section(&mut text, explanation, "\n", "");
    Some(text)
}

fn section(page: &mut String, explanation: &Explanation, open: &str, close: &str) {
    let Some(Example { text, parts, limit }) = explanation.example else { return };
    let limited = limit.map_or(String::new(), |(name, value)| match name {
        "dialect" => ", with `--dialect slides`".to_owned(),
        _ => format!(", with {name} = {value}"),
    });
    let block = |page: &mut String, title: &str, text: &str| {
        line(page, &format!("\n{title}:"));
        page.push_str(open);
        text.lines()
            .for_each(|row| line(page, &format!("{}{row}", if close.is_empty() { "    " } else { "" })));
        page.push_str(close);
    };
    block(page, &format!("An example{limited}"), text);
    for (name, content) in parts {
        match content {
            Some(content) => block(page, &format!("and in `{name}`"), content),
            None => line(page, &format!("\n`{name}` is there, but may not be read.")),
        }
    }
    if !explanation.repaired.is_empty() {
        block(page, "Put right", explanation.repaired);
    }
}

/// Lines of at most `columns` characters.
fn wrapped(page: &mut String, text: &str, columns: usize) {
    let mut column = 0;
    for word in text.split_whitespace() {
        let width = word.chars().count();
        if column > 0 {
            let breaks = column + 1 + width > columns;
            page.push(if breaks { '\n' } else { ' ' });
            column = if breaks { 0 } else { column + 1 };
        }
        page.push_str(word);
        column += width;
    }
    page.push('\n');
}

fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

fn line(page: &mut String, text: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(page, "{text}");
}
