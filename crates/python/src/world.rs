//! What rays meet, ready for pictures and for rays of one's own.

use crate::arrays::Table;
use crate::caster;
use crate::caster::Geometries;
use crate::caster::Reach;
use crate::caster::check_rays;
use crate::explain;
use crate::options::Choices;
use crate::options::threads;
use crate::pictures::into_array;
use crate::records::Teller;
use crate::signals::watched;
use crate::view::CameraNumbers;
use crate::view::LightNumbers;
use crate::view::camera;
use crate::view::light;
use dotray_geometry::Vec3;
use dotray_render::Layer;
use dotray_render::LayerFilm;
use dotray_render::LayerPicture;
use dotray_render::Observer;
use dotray_render::Progress;
use dotray_render::RenderError;
use dotray_render::Stats;
use dotray_render::camera::Camera;
use dotray_render::progress::Record;
use dotray_render::render;
use dotray_render::render_layers;
use dotray_render::tile::tiles;
use dotray_render::trace::Tracer;
use dotray_scene::model::Light;
use numpy::IntoPyArray;
use numpy::PyArray1;
use numpy::PyArray3;
use numpy::ndarray::Array3;
use pyo3::exceptions::PyRuntimeError;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;
use rayon::ThreadPoolBuilder;
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::MutexGuard;
use std::sync::PoisonError;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;

/// What rays meet. Pictures of one world are made one at a time, each by all threads.
#[pyclass(frozen, module = "dotray._dotray")]
pub struct World {
    world: Mutex<dotray_render::World>,
    /// The threads that rays of one's own run on, and the process that they belong to: a fork has none of them.
    pool: Mutex<Option<(u32, usize, Arc<ThreadPool>)>>,
    shape_count: usize,
}

/// Background, ambient light, lights.
pub(crate) type LightChoice = ([f64; 3], [f64; 3], Vec<LightNumbers>);

/// How far the picture has come, seen from Python's thread.
#[derive(Default)]
pub(crate) struct Watch {
    finished: AtomicU64,
    total: AtomicU64,
    pub(crate) cancel: AtomicBool,
}

impl Observer for Watch {
    fn tile_finished(&self, progress: &Progress) {
        self.finished.fetch_max(progress.finished_pixels, Ordering::Relaxed);
        self.total.store(progress.total_pixels, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

impl Watch {
    /// How far it has come.
    fn progress(&self) -> Progress {
        Progress {
            finished_pixels: self.finished.load(Ordering::Relaxed),
            total_pixels: self.total.load(Ordering::Relaxed),
        }
    }
}

pub(crate) fn render_fault(error: RenderError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

impl World {
    /// The world for Python.
    pub fn new(world: dotray_render::World) -> Self {
        let shape_count = world.shape_count();
        Self { world: Mutex::new(world), pool: Mutex::default(), shape_count }
    }

    pub(crate) fn locked(&self) -> MutexGuard<'_, dotray_render::World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// So many threads of this very process.
    fn threads(&self, asked: Option<usize>) -> PyResult<Arc<ThreadPool>> {
        let (process, count) = (std::process::id(), threads(asked));
        let mut kept = self.pool.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, known, pool)) = kept.as_ref()
            && (*of, *known) == (process, count)
        {
            return Ok(Arc::clone(pool));
        }
        let pool = ThreadPoolBuilder::new().num_threads(count).build();
        let pool = pool.map_err(|error| PyRuntimeError::new_err(format!("cannot start threads: {error}")))?;
        let pool = Arc::new(pool);
        let old = kept.replace((process, count, Arc::clone(&pool)));
        // The threads of the process before the fork are not here, and cannot be asked to end.
        std::mem::forget(old.filter(|(of, _, _)| *of != process));
        Ok(pool)
    }

    /// Asks the caster on threads.
    fn cast<T: Send>(
        &self,
        py: Python<'_>,
        asked: Option<usize>,
        ask: impl FnOnce(&dotray_render::Caster, &AtomicBool) -> T + Send,
    ) -> PyResult<T> {
        let (pool, cancel) = (self.threads(asked)?, AtomicBool::new(false));
        watched(
            py,
            &cancel,
            |_| Ok(()),
            || {
                let world = self.locked();
                pool.install(|| ask(world.caster(), &cancel))
            },
        )
    }
}

/// What may be set anew before a picture.
pub(crate) fn set_view(
    world: &mut dotray_render::World,
    seen: Option<CameraNumbers>,
    lit: Option<([Vec3; 2], Vec<Light>)>,
) {
    if let Some(numbers) = seen {
        world.set_camera(camera(numbers));
    }
    if let Some(([background, ambient], lights)) = lit {
        world.set_light(background, ambient, &lights);
    }
}

pub(crate) fn lighting(choice: Option<LightChoice>) -> PyResult<Option<([Vec3; 2], Vec<Light>)>> {
    let Some((background, ambient, lights)) = choice else { return Ok(None) };
    let lights = lights.iter().map(light).collect::<PyResult<Vec<_>>>()?;
    Ok(Some(([background, ambient].map(Vec3::from_array), lights)))
}

/// The layers of these names.
pub(crate) fn layers_of(names: &[String]) -> PyResult<Vec<Layer>> {
    let of_name = |name: &String| {
        Layer::ALL.into_iter().find(|layer| layer.name() == name).ok_or_else(|| {
            let known = Layer::ALL.map(Layer::name).join(", ");
            PyValueError::new_err(format!("layers has {name:?}; expected some of {known}"))
        })
    };
    names.iter().map(of_name).collect()
}

/// Layers by name, each as an array with its channels' names.
pub(crate) fn layer_arrays(py: Python<'_>, layers: Vec<LayerPicture>) -> PyResult<Bound<'_, PyDict>> {
    let told = PyDict::new(py);
    for layer in layers {
        let shape = (layer.height, layer.width, layer.layer.channels().len());
        let array = Array3::from_shape_vec(shape, layer.samples);
        let array = array.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        told.set_item(layer.layer.name(), (array.into_pyarray(py), layer.layer.channels().to_vec()))?;
    }
    Ok(told)
}

fn figures<'py>(py: Python<'py>, stats: &Stats) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("eye_rays", stats.eye_rays)?;
    told.set_item("shadow_rays", stats.shadow_rays)?;
    told.set_item("reflected_rays", stats.reflected_rays)?;
    told.set_item("refracted_rays", stats.refracted_rays)?;
    told.set_item("box_tests", stats.box_tests)?;
    told.set_item("shape_tests", stats.shape_tests)?;
    let memory = PyDict::new(py);
    for part in &stats.memory {
        memory.set_item(part.name, part.bytes)?;
    }
    told.set_item("memory", memory)?;
    let seconds = PyDict::new(py);
    for (stage, taken) in &stats.seconds {
        seconds.set_item(*stage, taken)?;
    }
    told.set_item("seconds", seconds)?;
    Ok(told)
}

#[pymethods]
impl World {
    /// How many shapes there are.
    #[getter]
    fn shape_count(&self) -> usize {
        self.shape_count
    }

    /// The smallest and the largest corner of the box around all shapes.
    fn bounds(&self, py: Python<'_>) -> ([f64; 3], [f64; 3]) {
        let bounds = py.detach(|| self.locked().bounds());
        (bounds.min.to_array(), bounds.max.to_array())
    }

    /// A picture and what it cost.
    #[pyo3(signature = (choices, camera=None, light=None, progress=None))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        choices: Choices,
        camera: Option<CameraNumbers>,
        light: Option<LightChoice>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyArray3<f32>>, Bound<'py, PyDict>)> {
        let (options, lit, watch) = (choices.options()?, lighting(light)?, Watch::default());
        options.validate().map_err(render_fault)?;
        let mut teller = Teller::new(progress.as_ref(), 0.0);
        let window = options.window();
        teller.begin(py, Record::Picture, [window.width, window.height], tiles(&options).len())?;
        let tick = |py: Python<'_>| teller.tell(py, &watch.progress());
        let rendering = watched(py, &watch.cancel, tick, || {
            let mut world = self.locked();
            set_view(&mut world, camera, lit);
            render(&world, &options, &watch)
        })?;
        let rendering = rendering.map_err(render_fault)?;
        teller.tell(py, &watch.progress())?;
        Ok((into_array(py, rendering.image)?, figures(py, &rendering.stats)?))
    }

    /// Layers of a picture by name, each with its channels' names; the work has begun so many seconds ago.
    #[pyo3(signature = (choices, names, camera=None, light=None, progress=None, since=0.0))]
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a choice of its own, and the Python half names them"
    )]
    fn layers<'py>(
        &self,
        py: Python<'py>,
        choices: Choices,
        names: Vec<String>,
        camera: Option<CameraNumbers>,
        light: Option<LightChoice>,
        progress: Option<Py<PyAny>>,
        since: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let wanted = layers_of(&names)?;
        let (options, lit, watch) = (choices.options()?, lighting(light)?, Watch::default());
        let bands = LayerFilm::new(&options, &wanted).map_err(render_fault)?.bands().len();
        let mut teller = Teller::new(progress.as_ref(), since);
        let window = options.window();
        teller.begin(py, Record::Layers, [window.width, window.height], bands)?;
        let tick = |py: Python<'_>| teller.tell(py, &watch.progress());
        let layers = watched(py, &watch.cancel, tick, || {
            let mut world = self.locked();
            set_view(&mut world, camera, lit);
            render_layers(&world, &options, &wanted, &watch)
        })?;
        let layers = layers.map_err(render_fault)?.unwrap_or_default();
        teller.tell(py, &watch.progress())?;
        layer_arrays(py, layers)
    }

    /// Why the ray through a place of the picture (in pixels from the upper left) has its colour.
    #[pyo3(signature = (choices, x, y, camera=None, light=None))]
    fn explain<'py>(
        &self,
        py: Python<'py>,
        choices: Choices,
        x: f64,
        y: f64,
        camera: Option<CameraNumbers>,
        light: Option<LightChoice>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (options, lit) = (choices.options()?, lighting(light)?);
        let node = py.detach(|| {
            let mut world = self.locked();
            set_view(&mut world, camera, lit);
            let camera = Camera::new(world.camera(), options.width, options.height);
            let mut tracer = Tracer::new(&world, &options, dotray_accel::simd::level());
            tracer.inspect(camera.ray(x, f64::from(options.height) - y))
        });
        explain::ray(py, &node.ok_or_else(|| PyRuntimeError::new_err("no ray was traced"))?)
    }

    /// What each ray meets first.
    #[pyo3(signature = (rays, geometries, t_min, t_max, coherent, surfaces, threads=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a choice of its own, and the Python half names them"
    )]
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        rays: Table<'py>,
        geometries: Geometries<'py>,
        t_min: f64,
        t_max: f64,
        coherent: bool,
        surfaces: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        check_rays(&rays)?;
        let (rows, reach) = (rays.rows(), Reach { t_min, t_max, coherent });
        let found =
            self.cast(py, threads, |shapes, cancel| caster::nearest(shapes, &rows, reach, surfaces, cancel))?;
        found.arrays(py, &geometries)
    }

    /// Whether anything lies on each ray.
    #[pyo3(signature = (rays, t_min, t_max, coherent, threads=None))]
    fn occluded<'py>(
        &self,
        py: Python<'py>,
        rays: Table<'py>,
        t_min: f64,
        t_max: f64,
        coherent: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        check_rays(&rays)?;
        let (rows, reach) = (rays.rows(), Reach { t_min, t_max, coherent });
        let found =
            self.cast(py, threads, |shapes, cancel| caster::occluded(shapes, &rows, reach, cancel))?;
        Ok(found.into_pyarray(py))
    }

    /// How many surfaces each ray crosses.
    #[pyo3(signature = (rays, t_min, t_max, coherent, threads=None))]
    fn count_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Table<'py>,
        t_min: f64,
        t_max: f64,
        coherent: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        check_rays(&rays)?;
        let (rows, reach) = (rays.rows(), Reach { t_min, t_max, coherent });
        let found = self.cast(py, threads, |shapes, cancel| caster::count(shapes, &rows, reach, cancel))?;
        Ok(found.into_pyarray(py))
    }

    /// Every surface that each ray crosses.
    #[pyo3(signature = (rays, geometries, t_min, t_max, coherent, threads=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "each is a choice of its own, and the Python half names them"
    )]
    fn all_hits<'py>(
        &self,
        py: Python<'py>,
        rays: Table<'py>,
        geometries: Geometries<'py>,
        t_min: f64,
        t_max: f64,
        coherent: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        check_rays(&rays)?;
        let (rows, reach) = (rays.rows(), Reach { t_min, t_max, coherent });
        let found = self.cast(py, threads, |shapes, cancel| caster::all(shapes, &rows, reach, cancel))?;
        found.arrays(py, &geometries)
    }
}
