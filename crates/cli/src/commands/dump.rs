//! `dotray dump`: the scene's tree as text.

use dotray::scene::dump::DumpOptions;
use dotray::scene::dump::dump;
use dotray::scene::resolve::resolve_within;
use std::io;
use std::io::BufWriter;
use std::io::Write;

use crate::args::DumpArgs;
use crate::exit::Failure;
use crate::exit::stdout_failure;
use crate::input::Written;
use crate::input::read;
use crate::limits::resolve_limits;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::values::When;

/// Prints the tree, then what is wrong with the scene: a tree helps to find a fault in it.
pub fn run(typed: &DumpArgs, color: When) -> Result<(), Failure> {
    let messages = Messages::new(color, false);
    let Written { scene, warnings, sources, .. } = read(&Place::of(&typed.scene), &typed.reading, messages)?;
    let mut out = BufWriter::new(io::stdout().lock());
    let printed = dump(&scene.files, DumpOptions { world: typed.world }, &mut out).and_then(|()| out.flush());
    printed.map_err(|error| stdout_failure(&error))?;
    let mut diagnostics = warnings;
    diagnostics.extend(resolve_within(scene, &resolve_limits(&typed.reading.limits)).diagnostics);
    if messages.print(&diagnostics, &sources) { Err(Failure::Reported) } else { Ok(()) }
}
