//! Bump images of the dialect `hmc`: a material names an image with `-u`, a shape says with a `-u` of its own how far
//! it leans the normals. Here a material has both, so one that is used in two ways becomes two.

use super::Parser;
use super::arguments;
use crate::diagnostic::Diagnostic;
use crate::lex;
use crate::model::BumpImage;
use crate::model::Material;
use crate::model::Placed;
use crate::span::Span;
use std::collections::BTreeMap;
use std::collections::BTreeSet;

/// The bump image that a material names.
pub(super) struct BumpFile {
    file: Vec<u8>,
    /// How far shapes lean by it.
    scales: Scales,
    /// The number of the texture, once some shape shows it.
    texture: Option<u32>,
}

/// The scales of all shapes of one material.
#[derive(Clone, Copy, PartialEq)]
enum Scales {
    /// There is no shape, or none has a scale.
    Zero,
    /// All have this one.
    Same(f64),
    /// They differ.
    Mixed,
}

/// The bump images of materials, by the materials' numbers.
pub(super) type BumpFiles = BTreeMap<usize, BumpFile>;

impl BumpFile {
    pub(super) fn new(file: Vec<u8>) -> Self {
        Self { file, scales: Scales::Zero, texture: None }
    }
}

impl Parser<'_> {
    /// The number after a shape's `-u`; 0 without.
    pub(super) fn bump_scale(&mut self) -> f64 {
        let Some(value) = self.named.bump.take() else { return 0.0 };
        if let Some(scale) = value.as_deref().and_then(|value| lex::number(value).ok()) {
            return scale;
        }
        let word = self.call.spec.word;
        let message = match value {
            Some(value) => {
                format!("`-u` of `{word}` has no effect: {} is no number", arguments::shown(&value))
            }
            None => format!("`-u` of `{word}` has no effect: its number is missing"),
        };
        self.ignored(&message);
        0.0
    }

    /// Gives each material the bump that all shapes of it share. `uses` are pairs of a material and a scale.
    pub(super) fn settle_bumps(&mut self, uses: impl Iterator<Item = (usize, f64)>) {
        let mut bumps = std::mem::take(&mut self.named.bumps);
        let mut seen = BTreeSet::new();
        for (material, scale) in uses {
            let first = seen.insert(material);
            let Some(bump) = bumps.get_mut(&material) else { continue };
            bump.scales = match bump.scales {
                Scales::Zero if first && scale != 0.0 => Scales::Same(scale),
                Scales::Zero if scale == 0.0 => Scales::Zero,
                Scales::Same(same) if same == scale => Scales::Same(same),
                Scales::Zero | Scales::Same(_) | Scales::Mixed => Scales::Mixed,
            };
        }
        for (&number, bump) in &mut bumps {
            let span = self.scene.materials.get(number).map(|material| material.span).unwrap_or_default();
            if bump.scales == Scales::Zero {
                self.sink.warn("ignored-part", || {
                    let shown = arguments::shown(&bump.file);
                    let message =
                        format!("the bump image {shown} has no effect: no shape of the material has `-u`");
                    Diagnostic::warning("ignored-part", message).at(span)
                });
            }
            if let Scales::Same(scale) = bump.scales {
                let texture = self.texture_number(bump.file.clone(), span);
                bump.texture = Some(texture);
                if let Some(material) = self.scene.materials.get_mut(number) {
                    material.value.bump = Some(BumpImage { texture, scale });
                }
            }
        }
        self.named.bumps = bumps;
    }

    /// How a shape shows the bump image of its material.
    pub(super) fn bump_of_use(&mut self, material: usize, scale: f64, span: Span) -> Option<BumpImage> {
        if scale == 0.0 {
            return None;
        }
        let known = self.named.bumps.get(&material).map(|bump| (bump.texture, bump.file.clone()));
        let texture = match known {
            Some((Some(texture), _)) => texture,
            Some((None, file)) => self.texture_number(file, span),
            None => {
                let message = "`-u` has no effect: the material names no bump image";
                self.sink.warn("ignored-part", || Diagnostic::warning("ignored-part", message).at(span));
                return None;
            }
        };
        Some(BumpImage { texture, scale })
    }

    /// Numbers textures in the order in which materials name them, so that a file that is written is read as the same.
    pub(super) fn order_textures(&mut self) {
        let materials = &mut self.scene.materials;
        if materials.iter().all(|placed| placed.value.bump.is_none()) {
            return;
        }
        let mut order: Vec<u32> = Vec::new();
        let mut places: BTreeMap<u32, u32> = BTreeMap::new();
        let mut place_of = |number: &mut u32| {
            let place = places.entry(*number).or_insert_with(|| {
                order.push(*number);
                order.len() as u32 - 1
            });
            *number = *place;
        };
        for Placed { value: Material { texture, bump, .. }, .. } in materials {
            texture.iter_mut().for_each(&mut place_of);
            bump.iter_mut().for_each(|bump| place_of(&mut bump.texture));
        }
        order.extend((0..self.scene.textures.len() as u32).filter(|number| !places.contains_key(number)));
        let textures = &self.scene.textures;
        let ordered = order.iter().filter_map(|&number| textures.get(number as usize).cloned());
        self.scene.textures = ordered.collect();
    }
}
