//! `dotray work`: one piece of a plan.

use dotray::image::write_file;
use dotray::render::Film;
use dotray::render::Observer;
use dotray::render::Picture;
use dotray::render::Tile;
use dotray::render::TilePixels;
use dotray::render::develop_part;
use dotray::render::tile_file::head_bytes;
use dotray::render::tile_file::read_tiles;
use serde_json::json;
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::PoisonError;

use crate::events;
use crate::exit::Failure;
use crate::exit::say;
use crate::interrupt;
use crate::keyframes::Animation;
use crate::long_args::ProgressName;
use crate::many_args::WorkArgs;
use crate::messages::Messages;
use crate::pieces::Part;
use crate::pieces::Piece;
use crate::pieces::PiecePlan;
use crate::plan::Plan;
use crate::plan::plan;
use crate::progress::Watcher;
use crate::stage::Stage;
use crate::values::When;

/// Computes the piece, unless it is there.
pub fn run(typed: &WorkArgs, color: When) -> Result<(), Failure> {
    let pieces = PiecePlan::read(&typed.plan)?;
    if typed.progress == ProgressName::Json {
        events::start("work", &pieces.scene, &typed.output.display().to_string());
    }
    let count = pieces.pieces.len();
    let Some(piece) = pieces.pieces.get(typed.piece as usize) else {
        return Err(Failure::Usage(format!(
            "the plan has no piece {}: its {count} pieces are numbered from 0",
            typed.piece
        )));
    };
    if piece.parts.is_empty() {
        say(&format!("piece {} is empty: the picture has fewer tiles than the plan has pieces", typed.piece));
        return Ok(());
    }
    let folder = &typed.output;
    fs::create_dir_all(folder).map_err(|error| Failure::file("make the folder", folder, &error))?;
    interrupt::watch();
    let threads: Vec<String> =
        typed.threads.map(|threads| format!("--threads={threads}")).into_iter().collect();
    let render = pieces.render_args(&threads)?;
    let plan = plan(&render)?;
    let film = Film::new(&plan.options)?;
    if film.tiles().len() as u32 != pieces.tiles {
        let tiles = film.tiles().len();
        return Err(Failure::Failed(format!(
            "the plan counts {} tiles; the picture has {tiles}",
            pieces.tiles
        )));
    }
    let missing = missing_parts(&pieces, typed.piece, piece, folder, film.tiles(), &plan);
    if missing.is_empty() {
        say(&format!("piece {} is there already", typed.piece));
        return Ok(());
    }
    let animation = pieces.animation.as_ref().map(|path| Animation::read(path.as_ref())).transpose()?;
    let (animation, text) = animation.map_or((Animation::default(), None), |(read, text)| (read, Some(text)));
    let mut stage = Stage::new(&plan, &render, Messages::new(color, true), animation)?;
    let mut fingerprint = stage.fingerprint()?;
    if let Some(text) = &text {
        fingerprint = fingerprint.with_hash_of("animation", text.as_bytes());
    }
    let differences = pieces.fingerprint(None).differences(&fingerprint, "in the plan", "here");
    if !differences.is_empty() {
        let list = differences.join("; ");
        return Err(Failure::Failed(format!(
            "the plan `{}` is of another picture ({list}); plan anew",
            typed.plan.display()
        )));
    }
    for part in missing {
        compute(&mut stage, &plan, &pieces, part, typed)?;
    }
    Ok(())
}

/// The parts that are not there whole.
fn missing_parts<'a>(
    pieces: &PiecePlan,
    number: u32,
    piece: &'a Piece,
    folder: &Path,
    tiles: &[Tile],
    plan: &Plan,
) -> Vec<&'a Part> {
    let is_missing = |part: &&Part| {
        let wanted = |tile: u32| tile >= part.first && tile - part.first < part.count;
        let mut there = vec![false; part.count as usize];
        let channels = if plan.options.transparent { 4 } else { 3 };
        let path = pieces.path(folder, number, part);
        let contents = read_tiles(&path, tiles, channels, |pixels| {
            if wanted(pixels.tile.number)
                && let Some(there) = there.get_mut((pixels.tile.number - part.first) as usize)
            {
                *there = true;
            }
        });
        let expected = pieces.fingerprint(part.frame);
        let same = contents.is_ok_and(|contents| contents.fingerprint == Some(expected));
        !same || there.contains(&false)
    };
    piece.parts.iter().filter(is_missing).collect()
}

fn compute(
    stage: &mut Stage<'_>,
    plan: &Plan,
    pieces: &PiecePlan,
    part: &Part,
    typed: &WorkArgs,
) -> Result<(), Failure> {
    if let Some(frame) = part.frame {
        events::emit("frame", json!({ "frame": frame, "frames": 1 }));
    }
    let set = stage.set(part.frame.unwrap_or(0))?;
    let picture = Picture::new(set.world, &plan.options)?;
    let film = picture.film()?;
    let tiles: Vec<Tile> =
        film.tiles().iter().skip(part.first as usize).take(part.count as usize).copied().collect();
    let pixels: u64 = tiles.iter().map(Tile::pixels).sum();
    let watcher = Watcher::new(pixels, typed.progress, false);
    let watcher = OfPart { watcher, pixels };
    let film = Mutex::new(film);
    let developed = develop_part(&picture, &film, &tiles, &watcher);
    watcher.watcher.finish();
    developed?;
    interrupt::check()?;
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut bytes = head_bytes(&pieces.fingerprint(part.frame));
    tiles.iter().filter_map(|tile| film.pixels(tile)).for_each(|pixels| bytes.extend(pixels.to_bytes()));
    let path = pieces.path(&typed.output, typed.piece, part);
    // Somebody may have taken the folder away meanwhile; where it cannot be made, the write says so.
    let _ = fs::create_dir_all(&typed.output);
    write_file(&path, &bytes).map_err(|error| Failure::Failed(error.to_string()))?;
    events::emit("saved", json!({ "kind": "piece", "file": path.display().to_string() }));
    Ok(())
}

/// Watches a part as if it were a picture.
struct OfPart {
    watcher: Watcher,
    pixels: u64,
}

impl Observer for OfPart {
    fn tile_traced(&self, pixels: &TilePixels) {
        tracing::trace!(number = pixels.tile.number, rays = pixels.counts.rays(), "a tile is finished");
    }

    fn tile_finished(&self, progress: &dotray::render::Progress) {
        let progress = dotray::render::Progress { total_pixels: self.pixels, ..*progress };
        self.watcher.tile_finished(&progress);
    }

    fn cancelled(&self) -> bool {
        self.watcher.cancelled()
    }
}
