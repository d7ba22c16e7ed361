//! Batches of rays against the shapes of a world.

use crate::arrays::Rows;
use crate::arrays::Table;
use dotray_accel::Queries;
use dotray_geometry::Ray;
use dotray_render::Caster;
use numpy::IntoPyArray;
use numpy::PyReadonlyArray1;
use numpy::ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;

/// As many rays as one thread takes at a time.
const PIECE: usize = 4096;

/// What stands for nothing: no geometry, no item.
const NOTHING: u32 = u32::MAX;

/// Which shapes belong to which geometry.
#[derive(FromPyObject)]
pub struct Geometries<'py> {
    /// The number of the first shape of each, ascending.
    first: PyReadonlyArray1<'py, u32>,
    /// What each is called.
    ids: PyReadonlyArray1<'py, u32>,
}

/// What part of each ray counts, and whether rays that follow each other start and run alike.
#[derive(Clone, Copy)]
pub struct Reach {
    /// From here …
    pub t_min: f64,
    /// … to here, in lengths of the ray's direction.
    pub t_max: f64,
    /// Whether they travel together.
    pub coherent: bool,
}

/// Some rays with directions of length 1, and the lengths that they had.
struct Piece {
    rays: Vec<Ray>,
    lengths: Vec<f64>,
    t_min: Vec<f64>,
    t_max: Vec<f64>,
}

impl Piece {
    fn new(rows: &Rows<'_>, start: usize, end: usize, reach: Reach) -> Self {
        let count = end - start;
        let mut piece = Self {
            rays: Vec::with_capacity(count),
            lengths: Vec::with_capacity(count),
            t_min: Vec::with_capacity(count),
            t_max: Vec::with_capacity(count),
        };
        for row in start..end {
            let (origin, direction) = (rows.vector(row), rows.vector_from(row, 3));
            let length = direction.length();
            // A direction whose length is 1 but for rounding stays as it is: t then is what it says.
            let is_unit = (length - 1.0).abs() < 1e-15;
            let length = if is_unit { 1.0 } else { length };
            piece.rays.push(Ray::new(origin, if is_unit { direction } else { direction / length }));
            piece.lengths.push(length);
            piece.t_min.push(reach.t_min * length);
            piece.t_max.push(reach.t_max * length);
        }
        piece
    }

    fn queries(&self) -> Queries<'_> {
        Queries { rays: &self.rays, t_min: &self.t_min, t_max: &self.t_max }
    }
}

/// A list for each piece of the rays, in order; pieces are left out once `cancel` is set.
fn by_pieces<T: Send>(
    rows: &Rows<'_>,
    reach: Reach,
    cancel: &AtomicBool,
    answer: impl Fn(usize, Piece) -> T + Sync,
) -> Vec<T> {
    let starts: Vec<usize> = (0..rows.len()).step_by(PIECE).collect();
    let piece = |start: usize| {
        let end = (start + PIECE).min(rows.len());
        (!cancel.load(Ordering::Relaxed)).then(|| answer(start, Piece::new(rows, start, end, reach)))
    };
    starts.into_par_iter().filter_map(piece).collect()
}

/// What rays met, one row a meeting.
#[derive(Default)]
pub struct Found {
    rays: Vec<u32>,
    t: Vec<f64>,
    numbers: Vec<u32>,
    normals: Vec<f64>,
    uvs: Vec<f64>,
}

/// The nearest shape of each ray; without `surfaces` neither normals nor texture coordinates.
pub fn nearest(caster: &Caster, rows: &Rows<'_>, reach: Reach, surfaces: bool, cancel: &AtomicBool) -> Found {
    let pieces = by_pieces(rows, reach, cancel, |_, piece| {
        let mut found = Found::default();
        let answers = caster.nearest(&piece.queries(), reach.coherent);
        for (index, answer) in answers.iter().enumerate() {
            let t = answer.map_or(f64::INFINITY, |nearest| nearest.hit.t / piece.lengths[index]);
            found.t.push(t);
            found.numbers.push(answer.map_or(NOTHING, |nearest| nearest.number));
            if surfaces {
                let surface = answer.map(|nearest| caster.surface(&piece.rays[index], &nearest));
                let normal = surface.map_or([0.0; 3], |surface| surface.geometric_normal.to_array());
                let uv = surface.map_or([0.0; 2], |surface| surface.in_object.texcoord.get().to_array());
                found.normals.extend(normal);
                found.uvs.extend(uv);
            }
        }
        found
    });
    gathered(pieces)
}

/// Whether anything lies on each ray.
pub fn occluded(caster: &Caster, rows: &Rows<'_>, reach: Reach, cancel: &AtomicBool) -> Vec<bool> {
    by_pieces(rows, reach, cancel, |_, piece| caster.occluded(&piece.queries(), reach.coherent)).concat()
}

/// How many surfaces each ray crosses.
pub fn count(caster: &Caster, rows: &Rows<'_>, reach: Reach, cancel: &AtomicBool) -> Vec<u32> {
    let pieces = by_pieces(rows, reach, cancel, |_, piece| {
        let mut counts = vec![0_u32; piece.rays.len()];
        for crossing in caster.crossings(&piece.queries(), reach.coherent) {
            counts[crossing.ray as usize] += 1;
        }
        counts
    });
    pieces.concat()
}

/// Every surface that each ray crosses, ray by ray and nearest first.
pub fn all(caster: &Caster, rows: &Rows<'_>, reach: Reach, cancel: &AtomicBool) -> Found {
    let pieces = by_pieces(rows, reach, cancel, |start, piece| {
        let mut found = Found::default();
        for crossing in caster.crossings(&piece.queries(), reach.coherent) {
            found.rays.push(start as u32 + crossing.ray);
            found.t.push(crossing.hit.t / piece.lengths[crossing.ray as usize]);
            found.numbers.push(crossing.number);
        }
        found
    });
    gathered(pieces)
}

fn gathered(pieces: Vec<Found>) -> Found {
    let mut all = Found::default();
    for mut piece in pieces {
        all.rays.append(&mut piece.rays);
        all.t.append(&mut piece.t);
        all.numbers.append(&mut piece.numbers);
        all.normals.append(&mut piece.normals);
        all.uvs.append(&mut piece.uvs);
    }
    all
}

impl Found {
    /// As arrays by name.
    pub fn arrays<'py>(self, py: Python<'py>, of: &Geometries<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (first, ids) = (of.first.as_array(), of.ids.as_array());
        let first = first.to_vec();
        let (mut geometries, mut items) = (self.numbers.clone(), self.numbers);
        for (geometry, item) in geometries.iter_mut().zip(&mut items).filter(|(g, _)| **g != NOTHING) {
            let place = first.partition_point(|first| first <= item).saturating_sub(1);
            (*geometry, *item) = (ids[place], *item - first[place]);
        }
        let arrays = PyDict::new(py);
        let table = |numbers: Vec<f64>, columns: usize| {
            Array2::from_shape_vec((numbers.len() / columns, columns), numbers)
                .map(|table| table.into_pyarray(py))
                .map_err(|error| pyo3::exceptions::PyRuntimeError::new_err(error.to_string()))
        };
        if !self.rays.is_empty() {
            arrays.set_item("ray_ids", self.rays.into_pyarray(py))?;
        }
        arrays.set_item("t_hit", self.t.into_pyarray(py))?;
        arrays.set_item("geometry_ids", geometries.into_pyarray(py))?;
        arrays.set_item("primitive_ids", items.into_pyarray(py))?;
        if !self.normals.is_empty() {
            arrays.set_item("normals", table(self.normals, 3)?)?;
            arrays.set_item("uvs", table(self.uvs, 2)?)?;
        }
        Ok(arrays)
    }
}

/// A table of rays has six columns.
pub fn check_rays(rays: &Table<'_>) -> PyResult<()> {
    let columns = match rays {
        Table::Single(table) => table.as_array().ncols(),
        Table::Double(table) => table.as_array().ncols(),
    };
    if columns == 6 {
        return Ok(());
    }
    Err(pyo3::exceptions::PyValueError::new_err(format!("rays has {columns} columns; expected 6")))
}
