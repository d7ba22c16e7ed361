//! `dotray format`: the canonical layout.

use dotray::image::write_file;
use dotray::scene::Files;
use dotray::scene::Severity;
use dotray::scene::format::format_text;
use dotray::scene::format::is_structural;
use dotray::scene::format::says_the_same;
use dotray::scene::load::load_text;
use dotray::scene::span::FileId;
use std::io;
use std::path::Path;
use std::path::PathBuf;

use crate::check_args::FormatArgs;
use crate::diff::short_diff;
use crate::exit::Failure;
use crate::exit::put;
use crate::exit::say;
use crate::input::standard_input;
use crate::limits::load_limits;
use crate::limits::load_options;
use crate::limits::reachable;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::reading_args::LimitArgs;
use crate::reading_args::ReadingArgs;
use crate::scenes::Asked;
use crate::scenes::expand;
use crate::values::When;

/// Formats all files, as far as they have no fault, and says at the end whether all went well.
pub fn run(typed: &FormatArgs, color: When) -> Result<(), Failure> {
    let messages = Messages::new(color, true);
    let mut at_fault = false;
    for asked in expand(&typed.files) {
        let good = match asked {
            Asked::Scene(place) => one(&place, typed, messages),
            Asked::Nothing(folder) => {
                say(&format!("error: there is no .ray file in or below the folder `{}`", folder.display()));
                Ok(false)
            }
        };
        match good {
            Ok(good) => at_fault |= !good,
            Err(failure) if matches!(failure, Failure::Failed(_)) => {
                let _ = failure.report();
                at_fault = true;
            }
            Err(failure) => return Err(failure),
        }
    }
    if at_fault { Err(Failure::Reported) } else { Ok(()) }
}

/// Formats one file; false where it is at fault or, where it is only checked, would change.
fn one(place: &Place, typed: &FormatArgs, messages: Messages) -> Result<bool, Failure> {
    let (name, old) = read(place, &typed.reading.limits)?;
    let Some(Layout { old, new }) = layout(&name, old, &typed.reading, messages)? else { return Ok(false) };
    let changes = old != new;
    match place {
        Place::File(_) | Place::Standard if typed.check => {
            if changes {
                let [old, new] = [&old, &new].map(|text| String::from_utf8_lossy(text));
                put(format!("{} would change\n{}", name.display(), short_diff(&old, &new)).as_bytes())?;
            }
            Ok(!changes)
        }
        Place::File(path) if !typed.stdout => {
            if changes {
                write_file(path, &new).map_err(|error| Failure::Failed(error.to_string()))?;
                say(&format!("formatted {}", path.display()));
            }
            Ok(true)
        }
        Place::File(_) | Place::Standard => put(&new).map(|()| true),
    }
}

fn read(place: &Place, limits: &LimitArgs) -> Result<(PathBuf, Vec<u8>), Failure> {
    let most = load_limits(limits).max_file_bytes;
    match place {
        Place::File(path) => {
            let disk = reachable(limits)?;
            let text = disk.read_at_most(path, most).map_err(|error| Failure::file("read", path, &error))?;
            Ok((path.clone(), text))
        }
        Place::Standard => {
            let text = standard_input(most)
                .map_err(|error| Failure::Failed(format!("cannot read standard input: {error}")))?;
            Ok((PathBuf::from("<stdin>"), text))
        }
    }
}

/// A text as it was and as it shall be.
struct Layout {
    old: Vec<u8>,
    new: Vec<u8>,
}

/// The text and its layout; `None` where the file has faults that leave its layout open, which are printed.
fn layout(
    name: &Path,
    text: Vec<u8>,
    reading: &ReadingArgs,
    messages: Messages,
) -> Result<Option<Layout>, Failure> {
    let options = load_options(reading);
    let loaded = load_text(&name.display().to_string(), text, &Nothing, &options);
    let structural = |code: &str| is_structural(code) && code != "cannot-read";
    let mut faults = loaded.diagnostics;
    let stopped = faults.iter().any(|fault| fault.code == "too-many-errors");
    faults.retain(|fault| fault.severity == Severity::Error && (stopped || structural(fault.code)));
    if !faults.is_empty() {
        messages.print(&faults, &loaded.sources);
        say(&format!("{} stays as it is", name.display()));
        return Ok(None);
    }
    let old = loaded.sources.bytes(FileId(0)).to_vec();
    let fault = |what: &dyn std::fmt::Display| {
        Failure::Failed(format!("cannot format `{}`: {what}; it stays as it is", name.display()))
    };
    let new = format_text(&old).map_err(|error| fault(&error))?;
    // The last word on the promise that the meaning never changes.
    if !says_the_same(&old, &new) {
        return Err(fault(&"its words would not stay the same, which is a fault of this program"));
    }
    Ok(Some(Layout { old, new }))
}

/// Included files have no say in a file's layout.
struct Nothing;

impl Files for Nothing {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::NotFound.into())
    }
}
