//! Records of progress as Python has them: dictionaries with the keys that docs/progress.md describes, made of the very
//! records that the program writes as lines.

use dotray_render::Progress;
use dotray_render::progress::Advance;
use dotray_render::progress::Extent;
use dotray_render::progress::Record;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// The dictionary of a record.
fn dictionary<'py>(py: Python<'py>, record: &Record) -> PyResult<Bound<'py, PyAny>> {
    let line = serde_json::to_string(record).map_err(|fault| PyRuntimeError::new_err(fault.to_string()))?;
    py.import("json")?.call_method1("loads", (line,))
}

/// Somebody in Python who hears of a picture, or of its layers.
pub struct Teller<'a> {
    function: Option<&'a Py<PyAny>>,
    meter: dotray_render::progress::Meter,
    /// Seconds between the start of the work and that of the picture.
    since: f64,
    /// Pixels that were told last.
    last: Option<u64>,
}

impl<'a> Teller<'a> {
    /// Somebody, or nobody, who began to listen so many seconds ago.
    pub fn new(function: Option<&'a Py<PyAny>>, since: f64) -> Self {
        Self { function, meter: dotray_render::progress::Meter::new(), since, last: None }
    }

    /// The picture, or its layers, are about to be traced: `kind` makes the record.
    pub fn begin(
        &mut self,
        py: Python<'_>,
        kind: fn(Extent) -> Record,
        size: [u32; 2],
        tiles: usize,
    ) -> PyResult<()> {
        let Some(function) = self.function else { return Ok(()) };
        let [width, height] = size;
        let total_pixels = u64::from(width) * u64::from(height);
        // The pace counts from here.
        self.meter.advance(&Progress { finished_pixels: 0, total_pixels });
        let extent = Extent {
            seconds: self.since + self.meter.seconds(),
            width,
            height,
            tiles: tiles as u64,
            finished_pixels: 0,
            total_pixels,
        };
        function.call1(py, (dictionary(py, &kind(extent))?,)).map(drop)
    }

    /// So far it is; what was told already is not told again.
    pub fn tell(&mut self, py: Python<'_>, progress: &Progress) -> PyResult<()> {
        let Some(function) = self.function else { return Ok(()) };
        if progress.total_pixels == 0 || self.last == Some(progress.finished_pixels) {
            return Ok(());
        }
        self.last = Some(progress.finished_pixels);
        let advance = self.meter.advance(progress);
        let record = Record::Progress(Advance { seconds: self.since + advance.seconds, ..advance });
        function.call1(py, (dictionary(py, &record)?,)).map(drop)
    }
}

/// Measures how fast pictures come that are put together in Python.
#[pyclass(module = "dotray._dotray")]
pub struct Meter(dotray_render::progress::Meter);

#[pymethods]
impl Meter {
    /// Measures from now on.
    #[new]
    fn new() -> Self {
        Self(dotray_render::progress::Meter::new())
    }

    /// The record `progress` for so many pixels.
    fn advance<'py>(
        &mut self,
        py: Python<'py>,
        finished_pixels: u64,
        total_pixels: u64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let advance = self.0.advance(&Progress { finished_pixels, total_pixels });
        dictionary(py, &Record::Progress(advance))
    }
}
