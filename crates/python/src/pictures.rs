//! Pictures between numpy, files and each other.

use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::ImageError;
use dotray_image::Limits;
use dotray_image::NamedChannel;
use dotray_image::compare::flip::flip;
use dotray_image::compare::largest_block;
use dotray_image::compare::ssim::ssim;
use numpy::IntoPyArray;
use numpy::PyArray3;
use numpy::PyReadonlyArray2;
use numpy::PyReadonlyArray3;
use numpy::ndarray::Array3;
use pyo3::exceptions::PyOSError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use pyo3::types::PyDict;
use std::path::PathBuf;

fn fault(error: ImageError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// The samples of a picture as an array, which takes them over.
pub fn into_array(py: Python<'_>, image: Image) -> PyResult<Bound<'_, PyArray3<f32>>> {
    let shape = (image.height(), image.width(), image.channels().count());
    let array = Array3::from_shape_vec(shape, image.into_samples());
    Ok(array.map_err(|error| PyValueError::new_err(error.to_string()))?.into_pyarray(py))
}

fn image(array: &PyReadonlyArray3<'_, f32>) -> PyResult<Image> {
    let array = array.as_array();
    let (height, width, channels) = array.dim();
    let channels = match channels {
        3 => Channels::Rgb,
        4 => Channels::Rgba,
        other => return Err(PyValueError::new_err(format!("{other} channels; expected 3 or 4"))),
    };
    Image::from_samples(width, height, channels, array.iter().copied().collect()).map_err(fault)
}

/// The picture of a file's bytes.
#[pyfunction]
pub fn decode<'py>(py: Python<'py>, bytes: &[u8]) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let image = py.detach(|| dotray_image::decode(bytes, None, &Limits::default())).map_err(fault)?;
    into_array(py, image)
}

/// The bytes of a picture's file; `name` chooses the format by its extension. Into OpenEXR, further channels go along.
#[pyfunction]
pub fn encode<'py>(
    py: Python<'py>,
    array: PyReadonlyArray3<'py, f32>,
    name: PathBuf,
    srgb: bool,
    jpeg_quality: u8,
    channels: Vec<(String, PyReadonlyArray2<'py, f32>)>,
) -> PyResult<Bound<'py, PyBytes>> {
    let format = Format::from_path(&name).map_err(fault)?;
    if !(1..=100).contains(&jpeg_quality) {
        return Err(PyValueError::new_err(format!("jpeg_quality is {jpeg_quality}; expected 1 to 100")));
    }
    let image = image(&array)?;
    let named = |(name, samples): &(String, PyReadonlyArray2<'py, f32>)| NamedChannel {
        name: name.clone(),
        samples: samples.as_array().iter().copied().collect(),
    };
    let channels: Vec<NamedChannel> = channels.iter().map(named).collect();
    let bytes = py.detach(|| match (format, channels.is_empty()) {
        (Format::Exr, false) => dotray_image::encode_exr_layers(&image, channels),
        (_, _) => dotray_image::encode(&image, format, &EncodeOptions { srgb, jpeg_quality }),
    });
    Ok(PyBytes::new(py, &bytes.map_err(fault)?))
}

/// Writes a file whole or not at all.
#[pyfunction]
pub fn write_file(py: Python<'_>, path: PathBuf, bytes: &[u8]) -> PyResult<()> {
    py.detach(|| dotray_image::write_file(&path, bytes))
        .map_err(|error| PyOSError::new_err(error.to_string()))
}

/// How far two pictures of one size are apart.
#[pyfunction]
pub fn compare<'py>(
    py: Python<'py>,
    a: PyReadonlyArray3<'py, f32>,
    b: PyReadonlyArray3<'py, f32>,
    tolerance: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let (a, b) = (image(&a)?, image(&b)?);
    let figures = py.detach(|| -> Result<_, ImageError> {
        let figures = dotray_image::compare::compare(&a, &b, tolerance)?;
        Ok((figures, ssim(&a, &b)?, flip(&a, &b)?.mean, largest_block(&a, &b)?))
    });
    let (figures, ssim, flip, block) = figures.map_err(fault)?;
    let told = PyDict::new(py);
    told.set_item("mean", figures.mean)?;
    told.set_item("max", figures.max)?;
    told.set_item("max_at", figures.max_at)?;
    told.set_item("rmse", figures.rmse)?;
    told.set_item("psnr", figures.psnr)?;
    told.set_item("ssim", ssim)?;
    told.set_item("flip", flip)?;
    told.set_item("block", block.difference)?;
    told.set_item("block_at", block.at)?;
    told.set_item("pixels_over", figures.pixels_over)?;
    told.set_item("pixels", figures.pixels)?;
    Ok(told)
}
