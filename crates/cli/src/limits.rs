//! What the typed limits mean to the library.

use dotray::render::Options;
use dotray::render::PrepareOptions;
use dotray::render::estimate::check_memory;
use dotray::render::estimate::machine_memory;
use dotray::scene::Files;
use dotray::scene::Resolved;
use dotray::scene::files::Confined;
use dotray::scene::files::Disk;
use dotray::scene::load;
use dotray::scene::load::LoadOptions;
use dotray::scene::resolve;

use crate::exit::Failure;
use crate::reading_args::LimitArgs;
use crate::reading_args::ReadingArgs;

/// How a scene is read.
pub fn load_options(reading: &ReadingArgs) -> LoadOptions {
    LoadOptions {
        dialect: reading.dialect.chosen(),
        limits: load_limits(&reading.limits),
        ..LoadOptions::default()
    }
}

/// What a file may make the reader do.
pub fn load_limits(typed: &LimitArgs) -> load::Limits {
    let defaults = load::Limits::default();
    // A text is in memory while it is read, and a few packed bytes can stand for any number of them. What is small
    // is read in any case, so that the estimate can say what it would take.
    let of_memory = typed.max_memory.map_or_else(machine_memory, |size| size.0).max(1 << 20);
    let count = |typed: Option<u32>, default: usize| {
        typed.map_or(default, |n| usize::try_from(n).unwrap_or(usize::MAX))
    };
    load::Limits {
        max_file_bytes: typed.max_file_size.map_or(of_memory.min(defaults.max_file_bytes), |size| size.0),
        max_include_depth: count(typed.max_include_depth, defaults.max_include_depth),
        max_includes: count(typed.max_includes, defaults.max_includes),
        max_shapes: typed.max_shapes.unwrap_or(defaults.max_shapes),
        max_nesting: count(typed.max_nesting, defaults.max_nesting),
        ..defaults
    }
}

/// How much instances may multiply.
pub fn resolve_limits(typed: &LimitArgs) -> resolve::Limits {
    let defaults = resolve::Limits::default();
    let shapes = typed.max_shapes.map_or(defaults.shapes, u64::from);
    match typed.max_groups.map(u64::from) {
        None => resolve::Limits { shapes, ..defaults },
        // A group is a step to its begin and one to its end; an instance is two more around what it holds.
        Some(groups) => resolve::Limits { shapes, runs: groups, steps: 4 * groups },
    }
}

/// The files that may be read.
pub fn reachable(typed: &LimitArgs) -> Result<Box<dyn Files + Send>, Failure> {
    match &typed.confine {
        None => Ok(Box::new(Disk)),
        Some(folder) => match Confined::new(Disk, folder) {
            Ok(confined) => Ok(Box::new(confined)),
            Err(error) => {
                let folder = folder.display();
                Err(Failure::Usage(format!("--confine {folder}: there is no such folder to read ({error})")))
            }
        },
    }
}

/// Refuses a scene that would take more memory than is allowed; without `options` no picture is made of it.
pub fn check(
    resolved: &Resolved,
    prepare: &PrepareOptions,
    options: Option<&Options>,
    typed: &LimitArgs,
) -> Result<(), Failure> {
    let limit = typed.max_memory.map_or_else(machine_memory, |size| size.0);
    check_memory(resolved, prepare, options, limit).map_err(|refused| Failure::Failed(refused.to_string()))
}
