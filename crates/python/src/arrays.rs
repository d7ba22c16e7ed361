//! Numbers that numpy holds, read where they lie.

use dotray_geometry::Affine;
use dotray_geometry::Mat4;
use dotray_geometry::Transform;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use numpy::PyReadonlyArray1;
use numpy::PyReadonlyArray2;
use numpy::ndarray::ArrayView1;
use numpy::ndarray::ArrayView2;
use pyo3::prelude::*;

/// A table in single or double precision, of any strides.
#[derive(FromPyObject)]
pub enum Table<'py> {
    /// Single.
    Single(PyReadonlyArray2<'py, f32>),
    /// Double.
    Double(PyReadonlyArray2<'py, f64>),
}

/// A list in single or double precision, of any stride.
#[derive(FromPyObject)]
pub enum List<'py> {
    /// Single.
    Single(PyReadonlyArray1<'py, f32>),
    /// Double.
    Double(PyReadonlyArray1<'py, f64>),
}

/// The rows of a table.
#[derive(Clone, Copy)]
pub enum Rows<'a> {
    /// Single.
    Single(ArrayView2<'a, f32>),
    /// Double.
    Double(ArrayView2<'a, f64>),
}

/// The numbers of a list.
#[derive(Clone, Copy)]
pub enum Numbers<'a> {
    /// Single.
    Single(ArrayView1<'a, f32>),
    /// Double.
    Double(ArrayView1<'a, f64>),
}

impl Table<'_> {
    /// Its rows.
    pub fn rows(&self) -> Rows<'_> {
        match self {
            Self::Single(table) => Rows::Single(table.as_array()),
            Self::Double(table) => Rows::Double(table.as_array()),
        }
    }
}

impl List<'_> {
    /// Its numbers.
    pub fn numbers(&self) -> Numbers<'_> {
        match self {
            Self::Single(list) => Numbers::Single(list.as_array()),
            Self::Double(list) => Numbers::Double(list.as_array()),
        }
    }
}

impl Rows<'_> {
    /// How many rows there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Single(rows) => rows.nrows(),
            Self::Double(rows) => rows.nrows(),
        }
    }

    /// A number of a row.
    #[inline]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        match self {
            Self::Single(rows) => f64::from(rows[[row, column]]),
            Self::Double(rows) => rows[[row, column]],
        }
    }

    /// Three numbers of a row.
    #[inline]
    pub fn vector(&self, row: usize) -> Vec3 {
        self.vector_from(row, 0)
    }

    /// Three numbers of a row from a column on.
    #[inline]
    pub fn vector_from(&self, row: usize, column: usize) -> Vec3 {
        Vec3::new(self.at(row, column), self.at(row, column + 1), self.at(row, column + 2))
    }

    /// Two numbers of a row.
    #[inline]
    pub fn pair(&self, row: usize) -> Vec2 {
        Vec2::new(self.at(row, 0), self.at(row, 1))
    }
}

impl Numbers<'_> {
    /// A number of the list.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Single(numbers) => f64::from(numbers[index]),
            Self::Double(numbers) => numbers[index],
        }
    }
}

/// The place, in row order, of the first number that is infinite or not a number.
#[pyfunction]
pub fn first_not_finite(table: Table<'_>) -> Option<usize> {
    match &table {
        Table::Single(table) => table.as_array().iter().position(|x| !x.is_finite()),
        Table::Double(table) => table.as_array().iter().position(|x| !x.is_finite()),
    }
}

/// The place, in row order, of the first number that is not above 0, or not finite.
#[pyfunction]
pub fn first_not_positive(table: Table<'_>) -> Option<usize> {
    match &table {
        Table::Single(table) => table.as_array().iter().position(|x| !(*x > 0.0 && x.is_finite())),
        Table::Double(table) => table.as_array().iter().position(|x| !(*x > 0.0 && x.is_finite())),
    }
}

/// The faces whose three corners lie on a line; all corners are known to be in range.
#[pyfunction]
pub fn faces_without_area(vertices: Table<'_>, faces: PyReadonlyArray2<'_, u32>) -> Vec<usize> {
    let (vertices, faces) = (vertices.rows(), faces.as_array());
    let flat = |face: ArrayView1<'_, u32>| {
        let corners = [face[0], face[1], face[2]].map(|corner| vertices.vector(corner as usize));
        Triangle::new(corners, [Vec3::ZERO; 3], [Vec2::ZERO; 3]).is_err()
    };
    faces.outer_iter().enumerate().filter(|(_, face)| flat(*face)).map(|(index, _)| index).collect()
}

/// A matrix given row by row.
pub fn matrix(rows: [f64; 16]) -> Mat4 {
    Mat4::from_cols_array(&rows).transpose()
}

/// Whether a 4 × 4 matrix, row by row, has no usable inverse.
#[pyfunction]
pub fn is_singular(rows: [f64; 16]) -> bool {
    Transform::new(Affine::from_mat4(matrix(rows))).is_err()
}
