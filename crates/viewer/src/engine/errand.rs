//! Tiles for a picture that is put together elsewhere.

use super::Part;
use super::Request;
use super::interrupt::Interrupt;
use super::job::trace;
use dotray_render::Parts;
use dotray_render::Picture;
use dotray_render::RenderError;
use dotray_render::Tile;
use dotray_render::World;
use dotray_render::tiles::COARSE_STEPS;
use std::collections::BTreeSet;
use std::collections::VecDeque;

/// Tiles that are traced for another.
#[derive(Debug)]
pub struct Errand {
    pub request: Request,
    /// All tiles of the picture, by their numbers.
    tiles: Vec<Tile>,
    /// Taken out while a portion is traced.
    parts: Option<Parts>,
    shares: VecDeque<(usize, Vec<Tile>)>,
}

impl Errand {
    /// For the picture of this request.
    ///
    /// # Errors
    /// Options that make no sense.
    pub fn new(world: &World, request: Request) -> Result<Self, RenderError> {
        let picture = Picture::new(world, &request.options)?;
        let (tiles, parts) = (picture.tiles().to_vec(), Some(picture.into_parts()));
        Ok(Self { request, tiles, parts, shares: VecDeque::new() })
    }

    /// Whether nothing is left of it.
    pub fn is_done(&self) -> bool {
        self.shares.is_empty()
    }

    pub fn take(&mut self, looks: usize, numbers: &[u32]) {
        let tiles = numbers.iter().filter_map(|number| self.tiles.get(*number as usize).copied());
        self.shares.push_back((looks, tiles.collect()));
    }

    pub fn portion(&mut self, world: &World, interrupt: &Interrupt<'_>) -> Option<Part> {
        let (looks, tiles) = self.shares.front_mut()?;
        let picture = Picture::of(world, &self.request.options, self.parts.take()?);
        let traced = trace(&picture, tiles, COARSE_STEPS.get(*looks).copied(), interrupt);
        self.parts = Some(picture.into_parts());
        let done: BTreeSet<u32> = traced.iter().map(|pixels| pixels.tile.number).collect();
        tiles.retain(|tile| !done.contains(&tile.number));
        let (looks, ended) = (*looks, tiles.is_empty());
        if ended {
            self.shares.pop_front();
        }
        (ended || !traced.is_empty()).then_some(Part {
            serial: self.request.serial,
            looks,
            tiles: traced,
            ended,
        })
    }
}
