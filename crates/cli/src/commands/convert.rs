//! `dotray convert`: a scene in another dialect.

use dotray::image::write_file;
use dotray::scene::Dialect;
use dotray::scene::convert::convert;
use dotray::scene::model::SceneFile;
use dotray::scene::resolve::resolve_within;
use std::fs;
use std::path::Path;
use std::path::PathBuf;

use crate::args::ConvertArgs;
use crate::exit::Failure;
use crate::exit::put;
use crate::exit::say;
use crate::input::Written;
use crate::input::read;
use crate::limits::resolve_limits;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::output;
use crate::reading_args::ReadingArgs;
use crate::values::When;

/// Writes the scene anew and says what is lost, a line each.
pub fn run(typed: &ConvertArgs, color: When) -> Result<(), Failure> {
    let (input, out) = (Place::of(&typed.input), Place::of(&typed.output));
    let to = typed.to.chosen().unwrap_or(Dialect::Slides);
    if let Place::File(_) = &out {
        output::check(&out, &input)?;
    }
    let messages = Messages::new(color, false);
    let reading = ReadingArgs { dialect: typed.from, limits: typed.limits.clone() };
    let Written { scene, warnings, sources, .. } = read(&input, &reading, messages)?;
    messages.print(&warnings, &sources);
    // What is wrong with the scene as a whole is told before a file of it stands there.
    let faults = resolve_within(scene.clone(), &resolve_limits(&typed.limits));
    if faults.resolved.is_none() {
        messages.print(&faults.diagnostics, &sources);
        return Err(Failure::Reported);
    }
    let folder = folder_of(&out);
    let texture = |file: &SceneFile, name: &str| renamed(&folder, &file.path, name);
    let converted = convert(&scene, to, &texture).map_err(|error| Failure::Failed(error.to_string()))?;
    for lost in &converted.lost {
        match lost.span {
            Some(span) => say(&format!("{}: not carried over: {}", sources.place(span), lost.message)),
            None => say(&format!("not carried over: {}", lost.message)),
        }
    }
    match &out {
        Place::Standard => put(converted.text.as_bytes()),
        Place::File(path) => {
            write_file(path, converted.text.as_bytes()).map_err(|error| Failure::Failed(error.to_string()))
        }
    }
}

/// The folder in which the new file will stand.
fn folder_of(out: &Place) -> PathBuf {
    let folder = match out {
        Place::Standard => PathBuf::new(),
        Place::File(path) => path.parent().map(Path::to_owned).unwrap_or_default(),
    };
    let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
    fs::canonicalize(&folder).unwrap_or(folder)
}

/// The name of a texture for a file in `folder`: as written where that finds nothing else.
fn renamed(folder: &Path, from: &Path, name: &str) -> String {
    let beside = from.parent().unwrap_or(Path::new("")).join(name.replace('\\', "/"));
    let Ok(texture) = fs::canonicalize(beside) else { return name.to_owned() };
    let ups = folder.ancestors().position(|above| texture.starts_with(above));
    let Some((ups, below)) = ups.and_then(|ups| {
        let above = folder.ancestors().nth(ups)?;
        Some((ups, texture.strip_prefix(above).ok()?))
    }) else {
        return texture.display().to_string();
    };
    let relative: PathBuf = std::iter::repeat_n("..", ups).map(Path::new).chain([below]).collect();
    relative.display().to_string()
}
