//! Pictures in pieces, as `dotray plan`, `dotray work` and `dotray merge` have them: tiles by number, each with a
//! checksum, behind a head that says to which picture they belong.

use crate::options::Choices;
use crate::pictures::into_array;
use crate::signals::watched;
use crate::view::CameraNumbers;
use crate::world::LightChoice;
use crate::world::Watch;
use crate::world::World;
use crate::world::layer_arrays;
use crate::world::layers_of;
use crate::world::lighting;
use crate::world::render_fault;
use crate::world::set_view;
use dotray_render::Fingerprint;
use dotray_render::LayerFilm;
use dotray_render::Observer;
use dotray_render::Options;
use dotray_render::Picture;
use dotray_render::Tile;
use dotray_render::TilePixels;
use dotray_render::layer_band;
use dotray_render::on_threads;
use dotray_render::tile_file::Known;
use dotray_render::tile_file::head_bytes;
use dotray_render::tile_file::read_bytes;
use numpy::PyArray3;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::ops::Range;

/// What pieces of one picture are put together on. Tiles are numbered first, bands of the layers after them.
#[pyclass(module = "dotray._dotray")]
pub struct Film {
    picture: dotray_render::Film,
    layers: LayerFilm,
    fingerprint: Fingerprint,
}

fn films(options: &Options, names: &[String]) -> PyResult<(dotray_render::Film, LayerFilm)> {
    let layers = LayerFilm::new(options, &layers_of(names)?).map_err(render_fault)?;
    Ok((dotray_render::Film::new(options).map_err(render_fault)?, layers))
}

/// What a picture is recognised by: a text that names its scene, its options and all else that it depends on.
fn fingerprint_of(picture: &str) -> Fingerprint {
    Fingerprint::default().with("picture", picture)
}

#[pymethods]
impl Film {
    /// All tiles missing; `picture` names what pieces must be of.
    #[new]
    fn new(choices: Choices, layers: Vec<String>, picture: &str) -> PyResult<Self> {
        let (film, layers) = films(&choices.options()?, &layers)?;
        Ok(Self { picture: film, layers, fingerprint: fingerprint_of(picture) })
    }

    /// How many tiles and how many bands there are.
    #[getter]
    fn counts(&self) -> (usize, usize) {
        (self.picture.tiles().len(), self.layers.bands().len())
    }

    /// How many pixels so many tiles and bands have from `first` on.
    fn pixels(&self, first: usize, count: usize) -> u64 {
        let all = self.picture.tiles().iter().chain(self.layers.bands());
        all.skip(first).take(count).map(Tile::pixels).sum()
    }

    /// Takes the tiles of a piece; false where one of those from `first` on is missing or damaged, or where they are of
    /// another picture.
    fn merge(&mut self, py: Python<'_>, piece: &[u8], first: u32, count: u32) -> bool {
        py.detach(|| {
            let (tiles, bands) = (self.picture.tiles().to_vec(), self.layers.bands().to_vec());
            let known = [
                Known { tiles: &tiles, channels: self.picture.channels() },
                Known { tiles: &bands, channels: self.layers.channels() },
            ];
            let mut found = Vec::new();
            let contents = read_bytes(piece, &known, |pixels| found.push(pixels));
            if contents.fingerprint.as_ref() != Some(&self.fingerprint) {
                return false;
            }
            let (picture, layers) = (&mut self.picture, &mut self.layers);
            let stored = found.iter().filter(|pixels| picture.store(pixels) || layers.store(pixels)).count();
            let there = |number: u32| found.iter().any(|pixels| pixels.tile.number == number);
            stored == count as usize || (first..first + count).all(there)
        })
    }

    /// Finished and all pixels, those of the layers with those of the picture.
    #[getter]
    fn progress(&self) -> (u64, u64) {
        let (picture, layers) = (self.picture.progress(), self.layers.progress());
        (picture.finished_pixels + layers.finished_pixels, picture.total_pixels + layers.total_pixels)
    }

    /// The picture and its layers, which leave the film.
    fn take<'py>(&mut self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray3<f32>>, Bound<'py, PyDict>)> {
        let empty = Options { width: 1, height: 1, ..Options::default() };
        let (nothing, none) = films(&empty, &[])?;
        let picture = std::mem::replace(&mut self.picture, nothing);
        let layers = std::mem::replace(&mut self.layers, none);
        Ok((into_array(py, picture.into_image())?, layer_arrays(py, layers.into_pictures())?))
    }
}

/// Computes tiles and bands by their numbers: the bytes of a piece of `picture`.
#[pyfunction]
#[pyo3(signature = (world, choices, layers, picture, first, count, camera=None, light=None))]
#[expect(clippy::too_many_arguments, reason = "each is a choice of its own, and the Python half names them")]
pub fn work<'py>(
    py: Python<'py>,
    world: &World,
    choices: Choices,
    layers: Vec<String>,
    picture: &str,
    first: u32,
    count: u32,
    camera: Option<CameraNumbers>,
    light: Option<LightChoice>,
) -> PyResult<Bound<'py, PyBytes>> {
    let (options, lit, wanted, watch) =
        (choices.options()?, lighting(light)?, layers_of(&layers)?, Watch::default());
    let bands = LayerFilm::new(&options, &wanted).map_err(render_fault)?;
    let numbers = first as usize..first as usize + count as usize;
    let tiles = watched(
        py,
        &watch.cancel,
        |_| Ok(()),
        || {
            let mut world = world.locked();
            set_view(&mut world, camera, lit);
            let picture = Picture::new(&world, &options)?;
            let tiles = within(picture.tiles(), numbers.clone());
            let after = picture.tiles().len();
            let bands =
                within(bands.bands(), numbers.start.saturating_sub(after)..numbers.end.saturating_sub(after));
            let run = || -> Option<Vec<TilePixels>> {
                let tiles = tiles.par_iter().with_max_len(1).map(|tile| picture.tile(tile, &watch));
                let band =
                    |band: &Tile| (!watch.cancelled()).then(|| layer_band(&world, &options, &wanted, band));
                tiles.chain(bands.par_iter().with_max_len(1).map(band)).collect()
            };
            on_threads(options.threads, run)
        },
    )?;
    let tiles = tiles.map_err(render_fault)?;
    let tiles = tiles.ok_or_else(|| PyRuntimeError::new_err("the piece was cancelled"))?;
    let mut bytes = head_bytes(&fingerprint_of(picture));
    tiles.iter().for_each(|pixels| bytes.extend(pixels.to_bytes()));
    Ok(PyBytes::new(py, &bytes))
}

/// Those of the tiles that lie in the range.
fn within(tiles: &[Tile], range: Range<usize>) -> &[Tile] {
    let end = range.end.min(tiles.len());
    tiles.get(range.start.min(end)..end).unwrap_or_default()
}
