//! Work for many machines: a plan that says which tiles of which frames make up a piece, as JSON.

use clap::Parser;
use dotray::render::Antialias;
use dotray::render::Film;
use dotray::render::Fingerprint;
use dotray::render::Layer;
use dotray::render::LayerFilm;
use dotray::render::Options;
use dotray::render::Shadows;
use dotray::render::TextureFilter;
use dotray::render::Tile;
use dotray::render::TilePixels;
use dotray::render::tile_file::Contents;
use dotray::render::tile_file::Known;
use dotray::render::tile_file::read_tiles;
use serde::Deserialize;
use serde::Serialize;
use std::fs;
use std::io;
use std::path::Path;
use std::path::PathBuf;

use crate::args::Cli;
use crate::args::Command;
use crate::exit::Failure;
use crate::layer_args::Background;
use crate::layers;
use crate::plan::Plan;
use crate::render_args::RenderArgs;
use crate::values::MissingTexture;

/// The version of the file's meaning.
pub const FORMAT: u32 = 1;

/// A plan.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PiecePlan {
    /// [`FORMAT`]
    pub dotray_plan: u32,
    /// The scene, as it was typed.
    pub scene: String,
    /// The options of `dotray render` that pictures depend on.
    pub options: Vec<String>,
    /// The animation, as it was typed.
    pub animation: Option<String>,
    /// How many tiles a picture has, the bands of its layers among them.
    pub tiles: u32,
    /// What the pictures depend on, their frames aside.
    pub fingerprint: Vec<(String, String)>,
    /// The pieces by number.
    pub pieces: Vec<Piece>,
}

/// Work for one machine at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Its estimated share of the whole cost, from 0 to 1.
    pub share: f64,
    /// What it is made of.
    pub parts: Vec<Part>,
}

/// Consecutive tiles of one picture; after the last one come the bands of its layers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The frame; null where there is no animation.
    pub frame: Option<u32>,
    /// The first tile.
    pub first: u32,
    /// How many tiles.
    pub count: u32,
}

impl Part {
    /// Whether the tile or band of this number is one of its.
    pub const fn holds(&self, number: u32) -> bool {
        number >= self.first && number - self.first < self.count
    }
}

/// A plan is small: more than this is something else.
const MOST_BYTES: u64 = 1 << 30;

impl PiecePlan {
    /// Reads a plan.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let fault = |error: &dyn std::fmt::Display| Failure::file("read", path, error);
        let length = fs::metadata(path).map_err(|error| fault(&error))?.len();
        if length > MOST_BYTES {
            return Err(fault(&format!("it has {length} bytes; no plan is that large")));
        }
        let bytes = fs::read(path).map_err(|error| fault(&error))?;
        let plan: Self = serde_json::from_slice(&bytes)
            .map_err(|error| Failure::Failed(format!("`{}` is no plan: {error}", path.display())))?;
        let inside = |part: &Part| part.first.checked_add(part.count).is_some_and(|end| end <= plan.tiles);
        let parts_fit = plan.pieces.iter().flat_map(|piece| &piece.parts).all(inside);
        if plan.dotray_plan != FORMAT || !parts_fit {
            return Err(Failure::Failed(format!(
                "`{}` is no plan of format {FORMAT}, or its numbers contradict each other",
                path.display()
            )));
        }
        Ok(plan)
    }

    /// What the picture of a frame depends on.
    pub fn fingerprint(&self, frame: Option<u32>) -> Fingerprint {
        let base =
            self.fingerprint.iter().fold(Fingerprint::default(), |all, (name, value)| all.with(name, value));
        match frame {
            Some(frame) => base.with("frame", &frame.to_string()),
            None => base,
        }
    }

    /// Refuses a scene, options or an animation other than those of the plan.
    pub fn check(&self, path: &Path, found: &Fingerprint) -> Result<(), Failure> {
        let differences = self.fingerprint(None).differences(found, "in the plan", "here");
        if differences.is_empty() {
            return Ok(());
        }
        let list = differences.join("; ");
        Err(Failure::Failed(format!(
            "the plan `{}` is of another picture ({list}); plan anew",
            path.display()
        )))
    }

    /// What `dotray render` would have been told; `more` are further options.
    pub fn render_args(&self, more: &[String]) -> Result<RenderArgs, Failure> {
        let words = ["dotray", "render", "--in"].map(str::to_owned).into_iter();
        let words = words.chain([self.scene.clone()]).chain(self.options.iter().cloned());
        let parsed = Cli::try_parse_from(words.chain(more.iter().cloned()));
        match parsed.map(|cli| cli.command) {
            Ok(Command::Render(typed)) => Ok(*typed),
            Ok(_) => Err(Failure::Failed("the plan holds no options of `dotray render`".to_owned())),
            Err(error) => Err(Failure::Failed(format!("the plan's options are not understood: {error}"))),
        }
    }

    /// The file of a part.
    pub fn path(&self, folder: &Path, piece: u32, part: &Part) -> PathBuf {
        folder.join(match part.frame {
            Some(frame) => format!("piece-{piece:05}.frame-{frame:05}.tiles"),
            None => format!("piece-{piece:05}.tiles"),
        })
    }
}

/// The options that pictures depend on, as they would be typed.
pub fn words_of(plan: &Plan, typed: &RenderArgs) -> Vec<String> {
    let Options {
        width,
        height,
        crop,
        recursion,
        threshold,
        antialias,
        shadows,
        texture_filter,
        light_samples,
        tile_size,
        ..
    } = &plan.options;
    let mut words = Vec::new();
    let mut say = |name: &str, value: String| words.push(format!("--{name}={value}"));
    say("size", format!("{width}x{height}"));
    if let Some(crop) = crop {
        say("crop", format!("{},{},{},{}", crop.x, crop.y, crop.width, crop.height));
    }
    say("recursion", recursion.to_string());
    say("cutoff", threshold.to_string());
    match antialias {
        Antialias::None => {}
        Antialias::Grid(n) => say("aa", format!("grid={n}")),
        Antialias::Adaptive { threshold, depth } => {
            say("aa", "adaptive".to_owned());
            say("aa-threshold", threshold.to_string());
            say("aa-depth", depth.to_string());
        }
    }
    let shadows = match shadows {
        Shadows::Filtered => "filtered",
        Shadows::Opaque => "opaque",
        Shadows::Off => "off",
    };
    say("shadows", shadows.to_owned());
    let filter = match texture_filter {
        TextureFilter::Bilinear => "bilinear",
        TextureFilter::Nearest => "nearest",
    };
    say("texture-filter", filter.to_owned());
    say("light-samples", light_samples.to_string());
    say("tile-size", tile_size.to_string());
    say("accel", plan.prepare.accel.name().to_owned());
    say("dialect", typed.reading.dialect.word().to_owned());
    if let Some(most) = typed.max_pixels {
        say("max-pixels", most.to_string());
    }
    if !plan.layers.is_empty() {
        say("layers", layers::names(&plan.layers));
    }
    match &typed.background {
        Some(Background::Color(color)) => say("background", format!("{},{},{}", color.x, color.y, color.z)),
        Some(Background::Transparent) => say("background", "transparent".to_owned()),
        Some(Background::Image(_)) | None => {}
    }
    match typed.missing_texture {
        MissingTexture::White => say("missing-texture", "white".to_owned()),
        MissingTexture::Error => {}
    }
    words
}

/// What the parts of one picture are put together on.
pub struct Sheet {
    /// The picture.
    pub picture: Film,
    /// Its layers.
    pub layers: LayerFilm,
}

impl Sheet {
    /// All is missing.
    pub fn new(options: &Options, layers: &[Layer]) -> Result<Self, Failure> {
        Ok(Self { picture: Film::new(options)?, layers: LayerFilm::new(options, layers)? })
    }

    /// How many tiles and bands there are.
    pub fn count(&self) -> u32 {
        (self.picture.tiles().len() + self.layers.bands().len()) as u32
    }

    /// The tiles of a part, and its bands.
    pub fn of_part(&self, part: &Part) -> (Vec<Tile>, Vec<Tile>) {
        let wanted = |tile: &&Tile| part.holds(tile.number);
        let [tiles, bands] = [self.picture.tiles(), self.layers.bands()];
        (tiles.iter().filter(wanted).copied().collect(), bands.iter().filter(wanted).copied().collect())
    }

    /// Reads the file of a part: shows each whole tile and band that belongs to it.
    pub fn read(&self, path: &Path, part: &Part, mut take: impl FnMut(TilePixels)) -> io::Result<Contents> {
        let known = [
            Known { tiles: self.picture.tiles(), channels: self.picture.channels() },
            Known { tiles: self.layers.bands(), channels: self.layers.channels() },
        ];
        read_tiles(path, &known, |pixels| {
            if part.holds(pixels.tile.number) {
                take(pixels);
            }
        })
    }

    /// Takes a tile or a band; false where it is none of this picture, or is there already.
    pub fn store(&mut self, pixels: &TilePixels) -> bool {
        self.picture.store(pixels) || self.layers.store(pixels)
    }

    /// Whether nothing is missing.
    pub fn is_complete(&self) -> bool {
        self.picture.is_complete() && self.layers.is_complete()
    }
}

/// Cuts tiles into `count` pieces of about the same cost, in order, the last of which are empty where there are fewer
/// to be made: a scheduler's tasks have numbers of their own, and each finds its piece. `costs` are those of each
/// picture's tiles.
pub fn cut(frames: &[Option<u32>], costs: &[&[f64]], count: u32) -> Vec<Piece> {
    let total: f64 = costs.iter().map(|tiles| tiles.iter().sum::<f64>()).sum();
    let mut pieces: Vec<Piece> = Vec::new();
    let (mut before, mut current) = (0.0, None);
    for (frame, tiles) in frames.iter().zip(costs) {
        for (tile, cost) in (0_u32..).zip(*tiles) {
            // The tile belongs to the piece that its middle falls into.
            let place = ((before + cost / 2.0) / total * f64::from(count)) as u32;
            before += cost;
            if current != Some(place) {
                current = Some(place);
                pieces.push(Piece { share: 0.0, parts: Vec::new() });
            }
            let Some(piece) = pieces.last_mut() else { continue };
            piece.share += cost / total;
            match piece.parts.last_mut().filter(|part| part.frame == *frame) {
                Some(part) => part.count += 1,
                None => piece.parts.push(Part { frame: *frame, first: tile, count: 1 }),
            }
        }
    }
    pieces.resize_with(count as usize, || Piece { share: 0.0, parts: Vec::new() });
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cost_the_same_and_hold_every_tile_once() {
        let (light, heavy) = ([1.0; 30], [7.0; 30]);
        let frames = [Some(4), Some(5)];
        let pieces = cut(&frames, &[&light, &heavy], 8);
        assert_eq!(pieces.len(), 8);
        for piece in &pieces {
            assert!((piece.share - 0.125).abs() < 0.03, "{piece:?}");
        }
        for frame in frames {
            let parts = pieces.iter().flat_map(|piece| &piece.parts).filter(|part| part.frame == frame);
            let end = parts.fold(0, |end, part| {
                assert_eq!(part.first, end);
                end + part.count
            });
            assert_eq!(end, 30);
        }
        let few = cut(&[None], &[&[5.0, 1.0]], 100);
        assert_eq!(few.len(), 100);
        assert_eq!(few.iter().filter(|piece| !piece.parts.is_empty()).count(), 2);
    }
}
