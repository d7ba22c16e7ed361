//! Colours that shapes have beside their materials: found for a run of shapes, and spelt out as materials for text.

use crate::model::Material;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::model::ShapeColors;
use crate::model::ShapeKind;
use crate::span::Span;
use dotray_geometry::Vec3;
use std::collections::HashMap;

impl SceneFile {
    /// The number of the list in [`SceneFile::colors`] that colours entry `first` of a kind, and its place there. The
    /// lists stand in the order of kinds (as [`ShapeKind::ALL`] has them) and entries.
    pub fn colors_from(&self, kind: ShapeKind, first: u32) -> Option<(u32, u32)> {
        let after = self.colors.partition_point(|list| (list.kind as u8, list.first) <= (kind as u8, first));
        let number = after.checked_sub(1)?;
        let list = self.colors.get(number)?;
        let place = first.checked_sub(list.first).filter(|_| list.kind == kind)?;
        ((place as usize) < list.colors.len()).then_some((number as u32, place))
    }

    /// The colours as materials, one for each pair of a material and a colour, in the order of their first use: the
    /// same scene as before, as text can hold it.
    pub fn spell_out_colors(&mut self) {
        let mut numbers: HashMap<(i32, [u32; 3]), i32> = HashMap::new();
        for ShapeColors { kind, first, colors } in std::mem::take(&mut self.colors) {
            for (index, color) in (first as usize..).zip(colors) {
                let Some(&written) = self.shape_materials(kind).get(index) else { continue };
                let key = (written, color.map(f32::to_bits));
                let number = *numbers.entry(key).or_insert_with(|| {
                    self.materials
                        .push(Placed { value: colored(self, written, color), span: Span::default() });
                    self.materials.len() as i32 - 1
                });
                if let Some(material) = self.shape_materials_mut(kind).get_mut(index) {
                    *material = number;
                }
            }
        }
    }
}

/// A material of the file (or the default one) with its ambient and diffuse colour multiplied: by the very products
/// that shading takes, so that both scenes give the same picture.
fn colored(file: &SceneFile, number: i32, color: [f32; 3]) -> Material {
    let written = usize::try_from(number).ok().and_then(|number| file.materials.get(number));
    let mut material = written.map_or_else(Material::default, |placed| placed.value.clone());
    let color = Vec3::from_array(color.map(f64::from));
    material.ambient *= color;
    material.diffuse *= color;
    material
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_geometry::Sphere;

    fn file() -> SceneFile {
        let mut file = SceneFile::default();
        for (index, material) in [0, -1, 0, 0, 0].into_iter().enumerate() {
            file.spheres.shapes.push(Sphere::new(Vec3::X * index as f64, 1.0).unwrap());
            file.spheres.materials.push(material);
        }
        let red = Material { diffuse: Vec3::new(0.5, 0.25, 0.125), k_specular: 0.5, ..Material::default() };
        file.materials.push(Placed { value: red, span: Span::default() });
        let colors = vec![[1.0, 0.0, 0.5], [0.5; 3], [1.0, 0.0, 0.5]];
        file.colors.push(ShapeColors { kind: ShapeKind::Sphere, first: 1, colors });
        file.colors.push(ShapeColors { kind: ShapeKind::Cone, first: 0, colors: vec![[1.0; 3]] });
        file
    }

    #[test]
    fn lists_are_found_by_kind_and_entry() {
        let file = file();
        let of = |kind, first| file.colors_from(kind, first);
        assert_eq!(
            [0, 1, 3, 4].map(|first| of(ShapeKind::Sphere, first)),
            [None, Some((0, 0)), Some((0, 2)), None]
        );
        assert_eq!(of(ShapeKind::Cone, 0), Some((1, 0)));
        assert_eq!(of(ShapeKind::Cuboid, 0), None);
    }

    #[test]
    fn colours_become_materials() {
        let mut file = file();
        file.spell_out_colors();
        assert!(file.colors.is_empty());
        // Entries 1 and 3 have the same colour, but not the same material.
        assert_eq!(file.spheres.materials, [0, 1, 2, 3, 0]);
        let diffuse: Vec<Vec3> = file.materials.iter().map(|placed| placed.value.diffuse).collect();
        assert_eq!(diffuse[1], Vec3::new(0.8, 0.0, 0.4));
        assert_eq!(diffuse[2], Vec3::new(0.25, 0.125, 0.0625));
        assert_eq!(diffuse[3], Vec3::new(0.5, 0.0, 0.0625));
        assert_eq!(file.materials[3].value.k_specular, 0.5);
    }
}
