//! Bump images, which only one dialect has.

use super::carry::Lost;
use super::carry::lose;
use crate::dialect::Dialect;
use crate::model::SceneFile;
use std::collections::BTreeMap;
use std::collections::BTreeSet;

/// Takes the bump images away, and their files where they are nothing else.
pub fn drop_bumps(file: &mut SceneFile, to: Dialect, lost: &mut Lost) {
    let mut bumps = BTreeSet::new();
    for placed in &mut file.materials {
        if let Some(bump) = placed.value.bump.take() {
            bumps.insert(bump.texture);
            let name = file.textures.get(bump.texture as usize).map_or("", |texture| &texture.value);
            let message = format!("`{to}` has no bump images: the surface is smooth without `{name}`");
            lose(lost, Some(placed.span), message);
        }
    }
    for placed in &file.materials {
        placed.value.texture.iter().for_each(|texture| {
            bumps.remove(texture);
        });
    }
    if bumps.is_empty() {
        return;
    }
    let kept = (0..file.textures.len() as u32).filter(|number| !bumps.contains(number));
    let places: BTreeMap<u32, u32> = kept.zip(0..).collect();
    let mut number = 0..;
    file.textures.retain(|_| number.next().is_some_and(|number| places.contains_key(&number)));
    for placed in &mut file.materials {
        let moved = placed.value.texture.map(|texture| places.get(&texture).copied().unwrap_or(texture));
        placed.value.texture = moved;
    }
}
