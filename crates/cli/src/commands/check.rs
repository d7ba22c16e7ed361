//! `dotray check`: every fault of every file, in one run.

use dotray::scene::Diagnostic;
use dotray::scene::Files;
use dotray::scene::codes::all_codes;
use dotray::scene::codes::explain;
use dotray::scene::load::load;
use dotray::scene::load::load_text;
use dotray::scene::look_over::look_over;
use dotray::scene::similar::near_names;
use dotray::scene::sources::Sources;
use dotray::scene::span::FileId;
use std::collections::HashSet;
use std::io;
use std::io::IsTerminal;
use std::path::Path;
use std::path::PathBuf;

use crate::check_args::CheckArgs;
use crate::check_args::CheckFormat;
use crate::exit::Failure;
use crate::exit::put;
use crate::findings::Finding;
use crate::findings::Report;
use crate::findings::github;
use crate::findings::json;
use crate::findings::sarif;
use crate::input::standard_input;
use crate::limits::load_options;
use crate::limits::reachable;
use crate::limits::resolve_limits;
use crate::meaning::Place;
use crate::messages::wants_color;
use crate::reading_args::ReadingArgs;
use crate::scenes::Asked;
use crate::scenes::expand;
use crate::textures::Textures;
use crate::values::When;

/// Prints all messages, or explains a code.
pub fn run(typed: &CheckArgs, color: When) -> Result<(), Failure> {
    if let Some(code) = &typed.explain {
        return put(explained(code)?.as_bytes());
    }
    let color = typed.format == CheckFormat::Text && wants_color(color, io::stdout().is_terminal());
    let disk = reachable(&typed.reading.limits)?;
    let mut textures = Textures::new(&*disk);
    let checked: Result<Vec<Checked>, Failure> = expand(&typed.files)
        .iter()
        .map(|asked| Checked::new(asked, &typed.reading, &*disk, &mut textures, color))
        .collect();
    let report = gather(checked?);
    let text = match typed.format {
        CheckFormat::Text => report.text(),
        CheckFormat::Json => json(&report),
        CheckFormat::Github => github(&report),
        CheckFormat::Sarif => sarif(&report),
    };
    put(text.as_bytes())?;
    let at_fault = report.errors() > 0 || (typed.strict && report.warnings() > 0);
    if at_fault { Err(Failure::Reported) } else { Ok(()) }
}

/// A scene that was looked at.
struct Checked {
    /// The paths of the file asked for and of those that it includes, in one form for each file.
    files: Vec<PathBuf>,
    findings: Vec<Finding>,
}

impl Checked {
    fn new(
        asked: &Asked,
        reading: &ReadingArgs,
        disk: &dyn Files,
        textures: &mut Textures<'_>,
        color: bool,
    ) -> Result<Self, Failure> {
        let options = load_options(reading);
        let (name, loaded) = match asked {
            Asked::Scene(Place::File(path)) => (path.clone(), load(path, disk, &options)),
            Asked::Scene(Place::Standard) => {
                let text = standard_input(options.limits.max_file_bytes)
                    .map_err(|error| Failure::Failed(format!("cannot read standard input: {error}")))?;
                (PathBuf::from(STANDARD), load_text(STANDARD, text, disk, &options))
            }
            Asked::Nothing(folder) => return Ok(Self::nothing(folder, color)),
        };
        let (diagnostics, sources) =
            look_over(loaded, &resolve_limits(&reading.limits), |named| textures.check(named));
        let scene = name.display().to_string();
        let findings = diagnostics.iter().map(|found| Finding::new(found, &sources, &scene, color)).collect();
        let numbers = 0..u32::try_from(sources.len()).unwrap_or(u32::MAX);
        let files = numbers.map(|number| disk.identity(sources.path(FileId(number)))).collect();
        Ok(Self { files, findings })
    }

    fn nothing(folder: &Path, color: bool) -> Self {
        let message = format!("there is no .ray file in or below the folder `{}`", folder.display());
        let error = Diagnostic::error("cannot-read", message);
        let scene = folder.display().to_string();
        Self { files: Vec::new(), findings: vec![Finding::new(&error, &Sources::default(), &scene, color)] }
    }
}

const STANDARD: &str = "<stdin>";

/// All scenes in one report. What several of them include is told once, and a file that others include is a part: it
/// needs neither camera nor lamps.
fn gather(checked: Vec<Checked>) -> Report {
    let parts: HashSet<PathBuf> =
        checked.iter().flat_map(|scene| scene.files.iter().skip(1).cloned()).collect();
    let mut report = Report { files: checked.len(), findings: Vec::new() };
    let mut told = HashSet::new();
    for Checked { files, findings } in checked {
        let is_part = files.first().is_some_and(|file| parts.contains(file));
        for finding in findings {
            let is_for_wholes = is_part && ["no-camera", "no-light"].contains(&finding.code);
            let again = !told.insert((finding.location.clone(), finding.code, finding.message.clone()));
            if !again && !is_for_wholes {
                report.findings.push(finding);
            }
        }
    }
    report
}

fn explained(typed: &str) -> Result<String, Failure> {
    let codes = all_codes();
    if ["all", "list"].contains(&typed) {
        let width = codes.iter().map(|code| code.name.len()).max().unwrap_or(0);
        return Ok(codes.iter().map(|code| format!("{:width$}  {}\n", code.name, code.meaning)).collect());
    }
    // As it stands in a message: error[code].
    let name = typed.split_once('[').map_or(typed, |(_, rest)| rest).trim_end_matches([']', ':']);
    explain(name).ok_or_else(|| {
        let near = near_names(name, codes.iter().map(|code| code.name));
        let meant = match near.as_slice() {
            [] => String::new(),
            [one] => format!("; did you mean `{one}`?"),
            many => format!(
                "; near to it are {}",
                many.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
            ),
        };
        Failure::Usage(format!("no code `{name}`{meant} (`dotray check --explain list` prints all)"))
    })
}
