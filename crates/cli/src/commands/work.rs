//! `dotray work`: one piece of a plan.

use dotray::image::write_file;
use dotray::render::LayerFilm;
use dotray::render::Observer;
use dotray::render::Picture;
use dotray::render::Progress;
use dotray::render::Tile;
use dotray::render::TilePixels;
use dotray::render::develop_bands;
use dotray::render::develop_part;
use dotray::render::progress::SavedKind;
use dotray::render::tile_file::head_bytes;
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
use crate::pieces::Sheet;
use crate::pieces::cut_out;
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
    let sheet = Sheet::new(&plan, &plan.layers)?;
    if sheet.count() != pieces.tiles {
        return Err(Failure::Failed(format!(
            "the plan counts {} tiles; the picture and its layers have {}",
            pieces.tiles,
            sheet.count()
        )));
    }
    let missing = missing_parts(&pieces, typed.piece, piece, folder, &sheet);
    if missing.is_empty() {
        say(&format!("piece {} is there already", typed.piece));
        return Ok(());
    }
    let animation = pieces.animation.as_ref().map(|path| Animation::read(path.as_ref())).transpose()?;
    let (animation, text) = animation.map_or((Animation::default(), None), |(read, text)| (read, Some(text)));
    // They are files of the merge; nothing is written beside the pieces.
    let bare = Plan { layers: Vec::new(), ..plan.clone() };
    let mut stage = Stage::new(&bare, &render, Messages::new(color, true), animation)?;
    pieces.check(&typed.plan, &stage.fingerprint(&plan, text.as_deref())?)?;
    let work = Work { plan: &plan, pieces: &pieces, typed };
    for part in missing {
        work.compute(&mut stage, part)?;
    }
    Ok(())
}

/// The parts that are not there whole.
fn missing_parts<'a>(
    pieces: &PiecePlan,
    number: u32,
    piece: &'a Piece,
    folder: &Path,
    sheet: &Sheet,
) -> Vec<&'a Part> {
    let is_missing = |part: &&Part| {
        let mut there = vec![false; part.count as usize];
        let contents = sheet.read(&pieces.path(folder, number, part), part, |pixels| {
            if let Some(there) = there.get_mut((pixels.tile.number - part.first) as usize) {
                *there = true;
            }
        });
        let expected = pieces.fingerprint(part.frame);
        let same = contents.is_ok_and(|contents| contents.fingerprint == Some(expected));
        !same || there.contains(&false)
    };
    piece.parts.iter().filter(is_missing).collect()
}

/// What all parts of a piece have in common.
struct Work<'a> {
    plan: &'a Plan,
    pieces: &'a PiecePlan,
    typed: &'a WorkArgs,
}

impl Work<'_> {
    /// Computes a part and writes its file.
    fn compute(&self, stage: &mut Stage<'_>, part: &Part) -> Result<(), Failure> {
        let Self { plan, pieces, typed } = self;
        if let Some(frame) = part.frame {
            events::frame(frame, 1);
        }
        let set = stage.set(part.frame.unwrap_or(0))?;
        let picture = Picture::new(set.world, &plan.options)?;
        let sheet = Sheet { picture: picture.film()?, layers: LayerFilm::new(&plan.options, &plan.layers)? };
        let (tiles, bands) = sheet.of_part(part);
        let pixels = |tiles: &[Tile]| tiles.iter().map(Tile::pixels).sum::<u64>();
        let all = pixels(&tiles) + pixels(&bands);
        let watcher = Watcher::new(all, typed.progress, false);
        watcher.tile_finished(&Progress { finished_pixels: 0, total_pixels: all });
        let Sheet { picture: film, layers } = sheet;
        let (film, layers) = (Mutex::new(film), Mutex::new(layers));
        let of_tiles = OfPart { watcher: &watcher, before: 0, all };
        let mut developed = Ok(());
        if !tiles.is_empty() {
            developed = develop_part(&picture, &film, &tiles, &of_tiles);
        }
        if developed.is_ok() && !bands.is_empty() {
            let of_bands = OfPart { before: pixels(&tiles), ..of_tiles };
            developed = develop_bands(set.world, &plan.options, &layers, &bands, &of_bands);
        }
        watcher.finish();
        developed?;
        interrupt::check()?;
        let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
        let layers = layers.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut bytes = head_bytes(&pieces.fingerprint(part.frame));
        let there: Vec<&Tile> = tiles.iter().filter(|tile| film.has(tile)).collect();
        // What lies behind and over a picture depends on the whole of it, and is drawn as if all of it were there.
        let image = set.extras.apply(film.into_image(), set.world, plan)?;
        let window = plan.options.window();
        let tiles = there.into_iter().map(|tile| cut_out(&image, window, tile));
        let bands = bands.iter().filter_map(|band| layers.pixels(band));
        tiles.chain(bands).for_each(|pixels| bytes.extend(pixels.to_bytes()));
        let path = pieces.path(&typed.output, typed.piece, part);
        // Somebody may have taken the folder away meanwhile; where it cannot be made, the write says so.
        let _ = fs::create_dir_all(&typed.output);
        write_file(&path, &bytes).map_err(|error| Failure::Failed(error.to_string()))?;
        events::saved(SavedKind::Piece, &path);
        Ok(())
    }
}

/// Watches a part as if it were a picture.
#[derive(Clone, Copy)]
struct OfPart<'a> {
    watcher: &'a Watcher,
    /// Pixels that were finished before.
    before: u64,
    all: u64,
}

impl Observer for OfPart<'_> {
    fn tile_traced(&self, pixels: &TilePixels) {
        tracing::trace!(number = pixels.tile.number, rays = pixels.counts.rays(), "a tile is finished");
    }

    fn tile_finished(&self, progress: &Progress) {
        let finished_pixels = self.before + progress.finished_pixels;
        self.watcher.tile_finished(&Progress { finished_pixels, total_pixels: self.all });
    }

    fn cancelled(&self) -> bool {
        self.watcher.cancelled()
    }
}
