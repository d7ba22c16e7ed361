//! `dotray tree`: a scene's groups with their boxes, or what an accelerator makes of it.

use dotray::accel::Stats;
use dotray::render::Caster;
use dotray::render::PrepareOptions;
use dotray::scene::Resolved;
use serde_json::Value;
use serde_json::json;
use std::io;
use std::io::BufWriter;
use std::io::IsTerminal;
use std::io::Write;

use crate::exit::Failure;
use crate::exit::put;
use crate::exit::stdout_failure;
use crate::input::Understood;
use crate::input::understand;
use crate::inspect_args::TreeArgs;
use crate::inspect_args::TreeFormat;
use crate::limits;
use crate::meaning;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::messages::wants_color;
use crate::tree::Tree;
use crate::tree::json::json as tree_json;
use crate::tree::svg::svg;
use crate::tree::text;
use crate::tree::text::Shown;
use crate::values::When;

/// Prints the tree or the figures.
pub fn run(typed: &TreeArgs, color: When) -> Result<(), Failure> {
    let messages = Messages::new(color, false);
    let place = Place::of(&typed.scene);
    let Understood { resolved, sources, .. } = understand(&place, &typed.reading, messages)?;
    if typed.accel.is_some() {
        return figures(typed, &resolved);
    }
    let tree = Tree::new(&resolved, &sources);
    match typed.format {
        TreeFormat::Text => {
            let color = wants_color(color, io::stdout().is_terminal());
            let mut out = BufWriter::new(io::stdout().lock());
            let shown = Shown { world: typed.world, shapes: typed.shapes, color };
            let printed = text::write(&tree, shown, &mut out).and_then(|()| out.flush());
            printed.map_err(|error| stdout_failure(&error))
        }
        TreeFormat::Json => put(format!("{:#}\n", tree_json(&tree, typed.world, typed.shapes)).as_bytes()),
        TreeFormat::Svg => put(svg(&tree, &typed.scene.display().to_string()).as_bytes()),
    }
}

fn figures(typed: &TreeArgs, resolved: &Resolved) -> Result<(), Failure> {
    if typed.format == TreeFormat::Svg {
        return Err(Failure::Usage(
            "--accel prints figures, as text or JSON; there is no drawing".to_owned(),
        ));
    }
    let kinds = typed.accel.map(|kind| kind.each()).unwrap_or_default();
    let figures = |kind| {
        let (accel, quality) = (meaning::accel(kind), meaning::quality(typed.build));
        let options = PrepareOptions { accel, quality, ..PrepareOptions::default() };
        limits::check(resolved, &options, None, &typed.reading.limits)?;
        Ok(Caster::build(resolved.clone(), &options).accelerator_stats())
    };
    let all: Vec<Stats> = kinds.into_iter().map(figures).collect::<Result<_, Failure>>()?;
    match typed.format {
        TreeFormat::Text | TreeFormat::Svg => put(all.iter().map(stats_text).collect::<String>().as_bytes()),
        TreeFormat::Json => {
            let all = json!({ "version": 1, "accelerators": all.iter().map(stats_json).collect::<Vec<_>>() });
            put(format!("{all:#}\n").as_bytes())
        }
    }
}

fn stats_text(stats: &Stats) -> String {
    let Stats { items, depth, nodes, leaves, references, sah_cost, bytes, .. } = stats;
    let mean = *references as f64 / (*leaves).max(1) as f64;
    let mut text = format!(
        "{}: {items} shapes\n  depth   {depth}\n  nodes   {nodes}\n  leaves  {leaves}, of {mean:.2} shapes on \
         average; {references} mentions of shapes in all\n  cost    {sah_cost:.2} expected tests of a ray that \
         meets the scene's box (surface-area heuristic)\n  memory  {bytes} bytes\n  leaf sizes\n",
        stats.kind.name()
    );
    let most = stats.leaf_sizes.iter().copied().max().unwrap_or(0).max(1);
    for (size, count) in stats.leaf_sizes.iter().copied().enumerate().filter(|(_, count)| *count > 0) {
        let more = if size == 16 { "+" } else { " " };
        let bar = "#".repeat((count * 40).div_ceil(most));
        text.push_str(&format!("    {size:>2}{more} {count:>9} {bar}\n"));
    }
    text
}

fn stats_json(stats: &Stats) -> Value {
    json!({
        "kind": stats.kind.name(),
        "shapes": stats.items,
        "depth": stats.depth,
        "nodes": stats.nodes,
        "leaves": stats.leaves,
        "references": stats.references,
        "leaf_sizes": stats.leaf_sizes,
        "sah_cost": stats.sah_cost,
        "bytes": stats.bytes,
    })
}
