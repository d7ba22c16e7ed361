//! `cargo xtask bench`: from what was typed to tables.

use crate::clock;
use crate::files;
use crate::images;
use crate::instructions;
use crate::kernels;
use crate::machine::Machine;
use crate::peers;
use crate::peers::Peers;
use crate::place::Place;
use crate::plan;
use crate::plan::Plan;
use crate::python;
use crate::report;
use crate::results::Part;
use crate::results::Results;
use clap::Args;

/// What was typed after `cargo xtask bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// First install the peers that can be had: Tachyon, POV-Ray, Embree, OVITO, Cycles.
    #[arg(long)]
    peers: bool,
    /// Small scenes, one round, under two minutes; docs/bench.md stays as it is.
    #[arg(long)]
    quick: bool,
    /// Only count the instructions of fixed pictures; more than 5 % above the committed counts is a fault.
    #[arg(long)]
    check: bool,
    /// With --check: commit the counts.
    #[arg(long, requires = "check")]
    update: bool,
    /// Only this part (images, rays, parse, memory, python) or scene (rnd6, knot2 …); may be given several times.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// How often each program runs [default: 3, with --quick 1].
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
}

/// Runs the bench.
///
/// # Errors
/// What stops it as a whole; peers that are missing do not.
pub fn run(arguments: &BenchArgs) -> Result<(), String> {
    let plan = Plan::new(arguments.quick, &arguments.only, arguments.rounds)?;
    if !clock::AVAILABLE {
        return Err("the bench needs a Unix: only there are the clocks that it reads".to_owned());
    }
    let place = Place::find()?;
    eprintln!("building");
    place.build_programs()?;
    if arguments.check {
        let action =
            if arguments.update { instructions::Action::Update } else { instructions::Action::Compare };
        return instructions::check(&place, action);
    }
    if arguments.peers {
        peers::install(&place);
    }
    let peers = Peers::find(&place);
    let machine = Machine::look(&place, peers.told());
    let found = measured(&plan, &place, &peers, &machine);
    let tables = report::tables(&found);
    for (name, table) in &tables {
        println!("## {name}\n\n{table}");
    }
    let path = place.bench.join(if plan.whole { "results.json" } else { "results-part.json" });
    let mut all = if plan.whole { Results::load(&path) } else { Results::default() };
    all.images = found.images.or(all.images);
    all.rays = found.rays.or(all.rays);
    all.parse = found.parse.or(all.parse);
    all.memory = found.memory.or(all.memory);
    all.python = found.python.or(all.python);
    all.store(&path)?;
    println!("Results are in {}.", path.display());
    if plan.whole {
        report::write_page(&place.root.join("docs/bench.md"), &tables)?;
    }
    Ok(())
}

/// Measures what the plan says.
fn measured(plan: &Plan, place: &Place, peers: &Peers, machine: &Machine) -> Results {
    let mut found = Results::default();
    for (part, scenes) in &plan.parts {
        let rounds = plan.rounds;
        let machine = machine.clone();
        eprintln!("{}", part.name());
        let scenes = available(place, scenes);
        match part {
            plan::Part::Images => {
                let rows = rows_of(&scenes, |scene| Ok(images::run(place, peers, scene, rounds)));
                found.images = Some(Part { machine, rounds, rows });
            }
            plan::Part::Rays => {
                let rows = rows_of(&scenes, |scene| kernels::rays(place, peers, scene, rounds));
                found.rays = Some(Part { machine, rounds, rows });
            }
            plan::Part::Parse => {
                let rows = rows_of(&scenes, |scene| kernels::parse(place, scene, rounds));
                found.parse = Some(Part { machine, rounds, rows });
            }
            plan::Part::Memory => {
                let rows = rows_of(&scenes, |scene| kernels::memory(place, peers, scene, rounds));
                found.memory = Some(Part { machine, rounds, rows });
            }
            plan::Part::Python => {
                let rows = rows_of(&scenes, |scene| python::run(place, peers, scene, rounds));
                found.python = Some(Part { machine, rounds, rows });
            }
        }
    }
    found
}

/// The scenes that can be had here.
fn available(place: &Place, scenes: &[String]) -> Vec<String> {
    let (shared, own): (Vec<_>, Vec<_>) = scenes.iter().cloned().partition(|scene| files::is_shared(scene));
    if shared.is_empty() || place.shared().is_some() {
        return scenes.to_vec();
    }
    eprintln!("  {}: skipped, no ../shared", shared.join(", "));
    own
}

/// The rows of all scenes; a scene that has none is told of and left out.
fn rows_of<Row>(scenes: &[String], rows: impl Fn(&str) -> Result<Vec<Row>, String>) -> Vec<Row> {
    let told = |scene: &String| {
        rows(scene).unwrap_or_else(|why| {
            eprintln!("  {scene}: left out: {why}");
            Vec::new()
        })
    };
    scenes.iter().flat_map(told).collect()
}
