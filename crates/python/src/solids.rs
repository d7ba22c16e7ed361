//! Shapes of arrays.

use crate::arrays::List;
use crate::arrays::Table;
use crate::builder::Builder;
use crate::builder::unplaced;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::ShapeError;
use dotray_geometry::Sphere;
use dotray_geometry::Vec3;
use dotray_scene::model::Item;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeColors;
use dotray_scene::model::ShapeKind;
use dotray_scene::model::ShapeList;
use dotray_scene::model::Vertex;
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyMemoryError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The most shapes of a scene: more than any accelerator takes.
const MOST: usize = 1 << 28;

fn fault(what: &str, index: usize, error: ShapeError) -> PyErr {
    PyValueError::new_err(format!("{what}[{index}]: {error}"))
}

/// Appends shapes of one kind with one material; gives the number of the first entry.
fn append<T>(
    list: &mut ShapeList<T>,
    material: i32,
    count: usize,
    shape: impl Fn(usize) -> PyResult<T>,
) -> PyResult<u32> {
    let first = list.shapes.len();
    if first + count > MOST {
        return Err(PyValueError::new_err(format!("{} shapes of a kind; at most {MOST}", first + count)));
    }
    let room = list.shapes.try_reserve_exact(count).and_then(|()| list.materials.try_reserve_exact(count));
    room.map_err(|_| PyMemoryError::new_err(format!("no memory for {count} shapes")))?;
    for index in 0..count {
        list.shapes.push(shape(index)?);
    }
    list.materials.resize(first + count, material);
    Ok(first as u32)
}

/// Names the colours of the shapes from entry `first` on.
fn add_colors(file: &mut SceneFile, kind: ShapeKind, first: u32, colors: Option<&PyReadonlyArray2<'_, f32>>) {
    if let Some(colors) = colors {
        let colors = colors.as_array().outer_iter().map(|row| [row[0], row[1], row[2]]).collect();
        file.colors.push(ShapeColors { kind, first, colors });
    }
}

/// One run of shapes.
fn add_run(file: &mut SceneFile, kind: ShapeKind, first: u32, count: usize) {
    if count > 0 {
        file.items.push(Item::Run { kind, first, count: count as u32 });
    }
}

/// A group for each shape: round shapes stand along y, so each needs a rigid motion of its own.
fn add_grouped(file: &mut SceneFile, kind: ShapeKind, first: u32, motions: impl Iterator<Item = Mat4>) {
    for (entry, motion) in (first..).zip(motions) {
        let group = file.groups.len() as u32;
        file.groups.push(unplaced(motion));
        file.items.extend([Item::Open(group), Item::Run { kind, first: entry, count: 1 }, Item::Close]);
    }
}

/// The rigid motion that takes y to the way from `start` to `end`, and the origin to its middle.
fn upright(start: Vec3, end: Vec3) -> Mat4 {
    let axis = (end - start).normalize_or(Vec3::Y);
    let across = axis.any_orthonormal_vector();
    let middle = start + (end - start) * 0.5;
    Mat4::from_cols(across.extend(0.0), axis.extend(0.0), across.cross(axis).extend(0.0), middle.extend(1.0))
}

/// Spheres of centres and radii.
#[pyfunction]
pub fn add_spheres(
    builder: &mut Builder,
    centers: Table<'_>,
    radii: List<'_>,
    material: i32,
    colors: Option<PyReadonlyArray2<'_, f32>>,
) -> PyResult<()> {
    let (centers, radii, file) = (centers.rows(), radii.numbers(), builder.file());
    let first = append(&mut file.spheres, material, centers.len(), |i| {
        Sphere::new(centers.vector(i), radii.at(i)).map_err(|error| fault("spheres", i, error))
    })?;
    add_colors(file, ShapeKind::Sphere, first, colors.as_ref());
    add_run(file, ShapeKind::Sphere, first, centers.len());
    Ok(())
}

/// Boxes along the axes.
#[pyfunction]
pub fn add_boxes(
    builder: &mut Builder,
    centers: Table<'_>,
    sizes: Table<'_>,
    material: i32,
    colors: Option<PyReadonlyArray2<'_, f32>>,
) -> PyResult<()> {
    let (centers, sizes, file) = (centers.rows(), sizes.rows(), builder.file());
    let first = append(&mut file.cuboids, material, centers.len(), |i| {
        Cuboid::new(centers.vector(i), sizes.vector(i)).map_err(|error| fault("boxes", i, error))
    })?;
    add_colors(file, ShapeKind::Cuboid, first, colors.as_ref());
    add_run(file, ShapeKind::Cuboid, first, centers.len());
    Ok(())
}

/// Cylinders from starts to ends; without `caps` their sides alone.
#[pyfunction]
pub fn add_cylinders(
    builder: &mut Builder,
    starts: Table<'_>,
    ends: Table<'_>,
    radii: List<'_>,
    caps: bool,
    material: i32,
    colors: Option<PyReadonlyArray2<'_, f32>>,
) -> PyResult<()> {
    let (starts, ends, radii, file) = (starts.rows(), ends.rows(), radii.numbers(), builder.file());
    let count = starts.len();
    let cylinder = |i: usize| {
        let height = (ends.vector(i) - starts.vector(i)).length();
        Cylinder::new(Vec3::ZERO, radii.at(i), height).map_err(|error| fault("cylinders", i, error))
    };
    let (kind, first) = if caps {
        (ShapeKind::Cylinder, append(&mut file.cylinders, material, count, cylinder)?)
    } else {
        let side = |i: usize| cylinder(i).map(OpenSide::Cylinder);
        (ShapeKind::Open, append(&mut file.open_sides, material, count, side)?)
    };
    add_colors(file, kind, first, colors.as_ref());
    add_grouped(file, kind, first, (0..count).map(|i| upright(starts.vector(i), ends.vector(i))));
    Ok(())
}

/// Cones from starts to ends, truncated where both radii are above 0; without `caps` their sides alone.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an array of its own, and the Python half names them")]
pub fn add_cones(
    builder: &mut Builder,
    starts: Table<'_>,
    ends: Table<'_>,
    radii: List<'_>,
    end_radii: List<'_>,
    caps: bool,
    material: i32,
    colors: Option<PyReadonlyArray2<'_, f32>>,
) -> PyResult<()> {
    let (starts, ends, file) = (starts.rows(), ends.rows(), builder.file());
    let (radii, end_radii, count) = (radii.numbers(), end_radii.numbers(), starts.len());
    let cone = |i: usize| {
        let height = (ends.vector(i) - starts.vector(i)).length();
        // A cone stands on a disc: one that begins with its apex is turned around.
        let (radius, top) =
            if radii.at(i) > 0.0 { (radii.at(i), end_radii.at(i)) } else { (end_radii.at(i), 0.0) };
        Cone::truncated(Vec3::ZERO, radius, top, height).map_err(|error| fault("cones", i, error))
    };
    let (kind, first) = if caps {
        (ShapeKind::Cone, append(&mut file.cones, material, count, cone)?)
    } else {
        let side = |i: usize| cone(i).map(OpenSide::Cone);
        (ShapeKind::Open, append(&mut file.open_sides, material, count, side)?)
    };
    add_colors(file, kind, first, colors.as_ref());
    let motions = (0..count).map(|i| {
        let (start, end) = (starts.vector(i), ends.vector(i));
        if radii.at(i) > 0.0 { upright(start, end) } else { upright(end, start) }
    });
    add_grouped(file, kind, first, motions);
    Ok(())
}

/// Triangles of shared vertices; all corners are known to be in range and all faces to have an area.
#[pyfunction]
pub fn add_triangles(
    builder: &mut Builder,
    vertices: Table<'_>,
    faces: PyReadonlyArray2<'_, u32>,
    normals: Option<Table<'_>>,
    uv: Option<Table<'_>>,
    material: i32,
    colors: Option<PyReadonlyArray2<'_, f32>>,
) -> PyResult<()> {
    let (vertices, faces, file) = (vertices.rows(), faces.as_array(), builder.file());
    let (normals, uv) = (normals.as_ref().map(Table::rows), uv.as_ref().map(Table::rows));
    let before = file.vertices.len();
    if before + vertices.len() > u32::MAX as usize {
        return Err(PyValueError::new_err("vertices: more than 32 bits can number"));
    }
    let room = file.vertices.try_reserve_exact(vertices.len());
    room.map_err(|_| PyMemoryError::new_err(format!("no memory for {} vertices", vertices.len())))?;
    file.vertices.extend((0..vertices.len()).map(|i| Vertex {
        position: vertices.vector(i),
        normal: normals.map_or(Vec3::ZERO, |normals| normals.vector(i)),
        texcoord: uv.map_or_else(Default::default, |uv| uv.pair(i)),
    }));
    let corner = |corner: u32| corner + before as u32;
    let face = |i: usize| Ok([corner(faces[[i, 0]]), corner(faces[[i, 1]]), corner(faces[[i, 2]])]);
    let first = append(&mut file.indexed_triangles, material, faces.nrows(), face)?;
    let flat = (first as usize..).zip(&file.indexed_triangles.shapes[first as usize..]);
    if let Some((i, _)) = flat.into_iter().find(|(_, face)| file.indexed_triangle(**face).is_none()) {
        return Err(fault("faces", i - first as usize, ShapeError::Area));
    }
    add_colors(file, ShapeKind::IndexedTriangle, first, colors.as_ref());
    add_run(file, ShapeKind::IndexedTriangle, first, faces.nrows());
    Ok(())
}
