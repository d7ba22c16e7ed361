//! Where in the text a shape, a light or a material stands, and in which groups.

use dotray::geometry::Aabb;
use dotray::scene::Resolved;
use dotray::scene::Sources;
use dotray::scene::model::Light;
use dotray::scene::resolved::Run;
use dotray::scene::span::FileId;
use dotray::scene::span::Span;
use dotray::scene::walk::DEFAULT_STEPS;
use dotray::scene::walk::Step;
use dotray::scene::walk::Walk;
use std::collections::BTreeMap;

/// A shape as people find it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapePlace {
    /// Its directive without `#shape_`, such as `sphere`.
    pub kind: String,
    /// `path:line:column`
    pub place: String,
    /// The groups and instances around it, the outermost first.
    pub groups: Vec<String>,
    /// Where its material stands; `None` for the default material.
    pub material_place: Option<String>,
    /// The box around it in the world.
    pub bounds: Aabb,
}

/// A light as people find it.
#[derive(Clone, Debug, PartialEq)]
pub struct LightPlace {
    /// `point`, `spot`, `directional` or `area`.
    pub kind: &'static str,
    /// `path:line:column`
    pub place: String,
}

/// The run of a shape and its entry in the run's list.
pub fn entry_of(resolved: &Resolved, number: u32) -> Option<(&Run, usize)> {
    let index = resolved.runs.partition_point(|run| run.first_shape <= number).checked_sub(1)?;
    let run = resolved.runs.get(index)?;
    let within = number.checked_sub(run.first_shape).filter(|within| *within < run.count)?;
    Some((run, (run.first + within) as usize))
}

/// The places of shapes by number.
pub fn shape_places(
    resolved: &Resolved,
    sources: &Sources,
    mut wanted: Vec<u32>,
) -> BTreeMap<u32, ShapePlace> {
    wanted.sort_unstable();
    wanted.dedup();
    let groups = groups_around(resolved, sources, &wanted);
    let described = |number: u32| Some((number, describe(resolved, sources, number)?));
    let mut places: BTreeMap<u32, ShapePlace> = wanted.into_iter().filter_map(described).collect();
    for (number, groups) in groups {
        if let Some(place) = places.get_mut(&number) {
            place.groups = groups;
        }
    }
    places
}

fn describe(resolved: &Resolved, sources: &Sources, number: u32) -> Option<ShapePlace> {
    let (run, entry) = entry_of(resolved, number)?;
    let file = resolved.files.get(run.file.0 as usize)?;
    let span = file.shape_span(run.file, run.kind, entry);
    let written = file.shape_materials(run.kind).get(entry).copied().unwrap_or(-1);
    let material = usize::try_from(written).ok().and_then(|index| file.materials.get(index));
    let shape = file.shape(run.kind, entry)?;
    let frame = resolved.frames.get(run.frame as usize)?;
    Some(ShapePlace {
        kind: run.kind.directive().trim_start_matches('#').trim_start_matches("shape_").to_owned(),
        place: span.map_or_else(String::new, |span| sources.place(span)),
        groups: Vec::new(),
        material_place: material.map(|placed| sources.place(placed.span)),
        bounds: shape.world_bounds(frame),
    })
}

/// Walks the tree once and takes down what is open around each wanted shape.
fn groups_around(resolved: &Resolved, sources: &Sources, wanted: &[u32]) -> Vec<(u32, Vec<String>)> {
    let mut found = Vec::new();
    let mut open: Vec<(FileId, Option<u32>, u32)> = Vec::new();
    let mut first_shape = 0_u32;
    for step in Walk::new(&resolved.files, DEFAULT_STEPS) {
        match step {
            Ok(Step::OpenGroup { file, group }) => open.push((file, Some(group), 0)),
            Ok(Step::OpenInstance { file, include, .. }) => open.push((file, None, include)),
            Ok(Step::CloseGroup | Step::CloseInstance) => {
                open.pop();
            }
            Ok(Step::Shapes { count, .. }) => {
                let end = first_shape.saturating_add(count);
                let from = wanted.partition_point(|number| *number < first_shape);
                let to = wanted.partition_point(|number| *number < end);
                for &number in wanted.get(from..to).unwrap_or_default() {
                    // Nobody reads a hundred thousand groups.
                    let around = open.iter().take(100);
                    let names = around.map(|&around| group_name(resolved, sources, around)).collect();
                    found.push((number, names));
                }
                first_shape = end;
            }
            Err(_) => break,
        }
    }
    found
}

fn group_name(
    resolved: &Resolved,
    sources: &Sources,
    (file, group, include): (FileId, Option<u32>, u32),
) -> String {
    let place = |span: Option<Span>| span.map_or_else(String::new, |span| sources.place(span));
    let file = resolved.files.get(file.0 as usize);
    match group {
        Some(group) => {
            let placed = file.and_then(|file| file.groups.get(group as usize));
            format!("group {}", place(placed.map(|placed| placed.span)))
        }
        None => {
            let placed = file.and_then(|file| file.includes.get(include as usize));
            let name = placed.map_or("", |placed| placed.value.name.as_str());
            format!("instance of {name} {}", place(placed.map(|placed| placed.span)))
        }
    }
}

/// The lights by number.
pub fn light_places(resolved: &Resolved, sources: &Sources) -> Vec<LightPlace> {
    let placed = resolved.files.first().map(|file| file.lights.as_slice()).unwrap_or_default();
    let kind = |light: &Light| match light {
        Light::Point { .. } => "point",
        Light::Spot { .. } => "spot",
        Light::Directional { .. } => "directional",
        Light::Area { .. } => "area",
    };
    let describe = |(number, light): (usize, &Light)| {
        let place = placed.get(number).map(|placed| sources.place(placed.span)).unwrap_or_default();
        LightPlace { kind: kind(light), place }
    };
    resolved.lights.iter().enumerate().map(describe).collect()
}
