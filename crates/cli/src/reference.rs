//! The reference of all commands in Markdown, made from the table that parses them.

use clap::Arg;
use clap::Command;
use clap::builder::StyledStr;
use std::fmt::Write;

const STATISTICS: &str = include_str!("statistics.md");

/// docs/cli.md.
pub fn markdown(program: &mut Command) -> String {
    program.build();
    let mut text =
        "# The command line of dotray\n\nMade from the program's own table by `dotray man --markdown`; \
                    do not edit. `dotray help COMMAND` prints the same.\n"
            .to_owned();
    page(program, &mut text);
    for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
        page(command, &mut text);
    }
    text.push('\n');
    text.push_str(STATISTICS);
    text
}

fn page(command: &Command, text: &mut String) {
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name());
    // Writing to a string does not fail.
    let _ = writeln!(text, "\n## `{name}`\n\n{}", plain(command.get_long_about().or(command.get_about())));
    let usage = command.clone().render_usage().to_string();
    let _ = writeln!(text, "\n```text\n{}\n```", usage.trim_start_matches("Usage:").trim());
    let shown: Vec<&Arg> = command.get_arguments().filter(|argument| is_listed(argument, command)).collect();
    let mut headings: Vec<&str> = Vec::new();
    for heading in shown.iter().map(|argument| heading(argument)) {
        if !headings.contains(&heading) {
            headings.push(heading);
        }
    }
    for wanted in headings {
        let _ = writeln!(text, "\n### {wanted}\n");
        for argument in shown.iter().filter(|argument| heading(argument) == wanted) {
            item(argument, text);
        }
    }
    if let Some(end) = command.get_after_long_help() {
        let _ = writeln!(text, "\n```text\n{}\n```", plain(Some(end)));
    }
}

/// Every page would say the same of `--help`, `--version`, `--color` and the log: the program's own page is enough.
fn is_listed(argument: &Arg, command: &Command) -> bool {
    let everywhere =
        ["help", "version", "color", "verbose", "log_format"].contains(&argument.get_id().as_str());
    !argument.is_hide_set() && (!everywhere || command.get_name() == "dotray")
}

fn heading(argument: &Arg) -> &str {
    if argument.is_positional() { "Arguments" } else { argument.get_help_heading().unwrap_or("Options") }
}

fn item(argument: &Arg, text: &mut String) {
    let values: Vec<&str> =
        argument.get_value_names().unwrap_or_default().iter().map(|name| name.as_str()).collect();
    let takes_value = argument.get_action().takes_values();
    let value = match (takes_value, argument.is_require_equals_set()) {
        (false, _) => String::new(),
        (true, false) => format!(" {}", values.join(" ")),
        (true, true) => format!("[={}]", values.join(" ")),
    };
    let short = argument.get_short().map(|letter| format!("-{letter}"));
    let long = argument.get_long().map(|word| format!("--{word}"));
    let aliases =
        argument.get_visible_aliases().unwrap_or_default().into_iter().map(|word| format!("--{word}"));
    let names: Vec<String> = short.into_iter().chain(long).chain(aliases).collect();
    let name = if names.is_empty() { values.join(" ") } else { names.join(", ") + &value };
    let help = plain(argument.get_long_help().or(argument.get_help()));
    let stop = if help.ends_with(['.', ']', ')']) { "" } else { "." };
    let _ = write!(text, "- `{name}`: {}{stop}", help.replace('\n', " "));
    let possible: Vec<_> = argument.get_possible_values().into_iter().filter(|v| !v.is_hide_set()).collect();
    if takes_value && !possible.is_empty() {
        let words = possible.iter().map(|value| match value.get_help() {
            Some(help) => format!("`{}` ({help})", value.get_name()),
            None => format!("`{}`", value.get_name()),
        });
        let _ = write!(text, " Values: {}.", words.collect::<Vec<_>>().join(", "));
    }
    let defaults: Vec<_> =
        argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if takes_value && !defaults.is_empty() {
        let _ = write!(text, " Default: `{}`.", defaults.join(" "));
    }
    text.push('\n');
}

fn plain(styled: Option<&StyledStr>) -> String {
    styled.map(|text| text.to_string().trim_end().to_owned()).unwrap_or_default()
}
