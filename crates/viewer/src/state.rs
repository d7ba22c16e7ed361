//! What the screen shows and what it can be asked to do; no widget is known here.

use crate::document::Document;
use crate::document::Message;
use crate::edit;
use crate::engine::Command;
use crate::engine::Reply;
use crate::engine::Request;
use crate::engine::Seen;
use crate::engine::whole_pixels;
use crate::gpu::Raster;
use crate::hidden::Hidden;
use crate::link::Link;
use crate::link::News;
use crate::link::Source;
use crate::navigate::Navigator;
use crate::outline::Selection;
use crate::rays;
use crate::rays::RayRow;
use dotray_accel::Kind;
use dotray_geometry::Vec3;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::progress::Advance;
use dotray_scene::Resolved;
use dotray_scene::model::Camera;
use dotray_scene::span::FileId;
use eframe::egui;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;

/// What fills the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Mode {
    /// The rasteriser's picture.
    #[default]
    Preview,
    /// The renderer's.
    Traced,
}

/// A traced picture, finished or not.
pub struct Traced {
    /// The request that it answers.
    pub request: Request,
    /// How far it has come.
    pub progress: Advance,
    /// The finished picture.
    pub image: Option<Arc<Image>>,
    /// The pixels on the screen; `None` before the first have come.
    pub texture: Option<egui::TextureHandle>,
}

/// The rays of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Rays {
    /// The rays, the eye ray first.
    pub rows: Arc<Vec<RayRow>>,
    /// Which one is looked at; `None` for all.
    pub chosen: Option<usize>,
    /// The pixel from the upper left.
    pub pixel: [u32; 2],
}

/// How long the camera rests before the picture is traced.
pub const REST: Duration = Duration::from_millis(350);

/// See the module.
pub struct State {
    /// The work behind the screen.
    pub link: Link,
    /// The rasteriser.
    pub raster: Option<Raster>,
    /// Where the scene comes from.
    pub source: Option<Source>,
    /// The scene.
    pub document: Option<Document>,
    /// The camera.
    pub navigator: Option<Navigator>,
    /// What fills the window.
    pub mode: Mode,
    /// Whether the picture is traced when the camera rests.
    pub trace_at_rest: bool,
    /// What is asked of the tracer; the size is the window's.
    pub options: Options,
    /// Its accelerator.
    pub accel: Kind,
    /// The part of the window that is traced: fractions from the left and from above.
    pub region: Option<[f64; 4]>,
    /// The traced picture.
    pub traced: Option<Traced>,
    /// Whether the tracer has the scene.
    pub prepared: bool,
    /// How many threads trace; `None` where another program does not tell.
    pub tracers: Option<usize>,
    /// Which shapes are not shown.
    pub hidden: Hidden,
    /// What is selected.
    pub selection: Option<Selection>,
    /// Whether boxes around what is selected are drawn.
    pub show_bounds: bool,
    /// The rays of a pixel.
    pub rays: Option<Rays>,
    /// What lies under the pointer.
    pub hovered: Option<Seen>,
    /// What was wrong with the file when it was last read, or what it warns of.
    pub messages: Vec<Message>,
    /// The last thing that was done, or why it was not.
    pub notice: String,
    /// The size of the view in pixels.
    pub size: [u32; 2],
    /// When the camera moved last.
    pub moved: Instant,
    /// Whether the rasteriser's picture is out of date.
    pub stale: bool,
    /// The pixel whose rays were asked for.
    asked_pixel: [u32; 2],
    serial: u64,
}

impl State {
    /// Nothing to show yet.
    pub fn new(link: Link) -> Self {
        Self {
            tracers: link.threads(),
            link,
            raster: None,
            source: None,
            document: None,
            navigator: None,
            mode: Mode::Preview,
            trace_at_rest: false,
            options: Options::default(),
            accel: Kind::default(),
            region: None,
            traced: None,
            prepared: false,
            hidden: Hidden::default(),
            selection: None,
            show_bounds: true,
            rays: None,
            hovered: None,
            messages: Vec::new(),
            notice: String::new(),
            size: [1, 1],
            moved: Instant::now(),
            stale: true,
            asked_pixel: [0, 0],
            serial: 0,
        }
    }

    /// Reads another scene.
    pub fn open(&mut self, source: Source) {
        (self.document, self.navigator, self.prepared) = (None, None, false);
        self.hidden.clear();
        self.drop_picture();
        self.source = Some(source);
        self.reload();
    }

    /// Reads the scene again; the view stays, and the last good scene until there is a better one.
    pub fn reload(&mut self) {
        let prepare = PrepareOptions { accel: self.accel, ..PrepareOptions::default() };
        if let Some(source) = &self.source {
            self.link.open(source.clone(), prepare, self.document.is_none());
        }
    }

    /// Reads the scene again because its files have changed, unless that would drop what was edited.
    pub fn changed_outside(&mut self) {
        if self.document.as_ref().is_some_and(Document::is_edited) {
            let what = "the file has changed on the disk; Undo all reads it and drops what was edited here";
            self.notice = what.to_owned();
        } else {
            self.reload();
        }
    }

    /// A scene that another program has sent: another one, or the same after a change.
    fn sent(&mut self, source: Source) {
        if self.source.as_ref().is_some_and(|old| old.path == source.path) {
            self.source = Some(source);
            self.changed_outside();
        } else {
            self.open(source);
        }
    }

    /// Takes what has come; answers whether a scene was among it.
    pub fn take_news(&mut self, ctx: &egui::Context) -> bool {
        let mut any = false;
        for news in self.link.news() {
            match news {
                News::Opened(document) => {
                    self.opened(*document);
                    any = true;
                }
                News::Failed(messages) => self.messages = messages,
                News::Prepared(_) => self.prepared_now(),
                News::Tracers(count) => self.tracers = Some(count),
                News::Sent(source) => self.sent(source),
                News::Notice(sentence) => self.notice = sentence,
                News::Reply(reply) => self.reply(reply, ctx),
            }
        }
        any
    }

    fn opened(&mut self, document: Document) {
        let (camera, bounds) = (document.camera, document.packed.bounds);
        // Numbers of shapes mean other shapes where shapes came or went.
        if self.document.as_ref().is_some_and(|old| old.shape_count != document.shape_count) {
            self.hidden.clear();
        }
        self.navigator = Some(match self.navigator {
            Some(navigator) => navigator.moved_to(camera, &bounds),
            None => Navigator::new(camera, &bounds),
        });
        if let Some(raster) = &mut self.raster {
            raster.load(&document.packed, document.draft.as_ref(), &document.pictures, &document.style);
            raster.hide(&self.hidden);
        }
        self.messages.clone_from(&document.messages);
        (self.rays, self.selection, self.hovered) = (None, None, None);
        // The tracer has another scene until it tells that it has this one.
        self.prepared = false;
        self.drop_picture();
        self.document = Some(document);
        self.stale = true;
    }

    fn prepared_now(&mut self) {
        (self.prepared, self.tracers) = (true, self.link.threads());
        if let Some(document) = self.document.as_ref().filter(|document| document.is_edited()) {
            self.link.send(Command::Style(Box::new(document.style.clone())));
        }
        if !self.hidden.is_empty() {
            self.link.send(Command::Hide(self.hidden.clone()));
        }
        self.restart();
    }

    fn reply(&mut self, reply: Reply, ctx: &egui::Context) {
        match reply {
            Reply::Picture { serial, size, pixels, progress, image } => {
                let Some(traced) = self.traced.as_mut().filter(|traced| traced.request.serial == serial)
                else {
                    return;
                };
                (traced.progress, traced.image) = (progress, image);
                let shown = egui::ColorImage::from_rgba_premultiplied(size, &pixels);
                match &mut traced.texture {
                    Some(texture) => texture.set(shown, egui::TextureOptions::NEAREST),
                    None => {
                        traced.texture =
                            Some(ctx.load_texture("traced", shown, egui::TextureOptions::NEAREST));
                    }
                }
            }
            Reply::Seen(seen) => self.hovered = seen,
            Reply::Rays(rows) => self.rays_came(rows),
            Reply::Refused(sentence) => self.notice = sentence,
            // Nobody helps a screen.
            Reply::Part(_) => {}
        }
    }

    fn rays_came(&mut self, rows: Arc<Vec<RayRow>>) {
        let met = rows.first().and_then(|row| row.met);
        self.rays = Some(Rays { rows, chosen: None, pixel: self.asked_pixel });
        match met {
            Some((number, _)) => self.select(number..number + 1),
            None => self.selection = None,
        }
        self.redraw_lines();
    }

    /// The camera, the file's or the user's.
    pub fn camera(&self) -> Option<Camera> {
        self.navigator.map(|navigator| navigator.camera())
    }

    /// Leads the camera.
    pub fn navigate(&mut self, lead: impl FnOnce(&mut Navigator)) {
        if let Some(navigator) = &mut self.navigator {
            let before = navigator.camera();
            lead(navigator);
            if navigator.camera() != before {
                self.moved();
            }
        }
    }

    /// The view has changed: a picture under way is of no use.
    pub fn moved(&mut self) {
        self.stale = true;
        self.moved = Instant::now();
        self.restart();
    }

    /// Drops the traced picture, and begins another where it is to be seen at once.
    pub fn restart(&mut self) {
        self.drop_picture();
        if self.mode == Mode::Traced {
            self.start_tracing();
        }
    }

    fn drop_picture(&mut self) {
        if self.traced.take().is_some() {
            self.link.send(Command::Stop);
        }
    }

    /// Begins a picture, unless there is one.
    pub fn start_tracing(&mut self) {
        if !self.prepared || self.traced.is_some() {
            return;
        }
        if let Some(request) = self.request(true) {
            self.link.send(Command::Draw(Box::new(request.clone())));
            self.traced = Some(Traced { request, progress: Advance::default(), image: None, texture: None });
        }
    }

    /// Whether a traced picture will soon hide all that is drawn of the scene.
    pub fn is_being_traced(&self) -> bool {
        let of_all = |traced: &Traced| traced.image.is_none() && traced.request.options.crop.is_none();
        self.traced.as_ref().is_some_and(of_all)
    }

    /// What is to be traced now.
    fn request(&mut self, with_region: bool) -> Option<Request> {
        self.serial += 1;
        let [width, height] = self.size;
        let mut options = Options { width, height, crop: None, ..self.options.clone() };
        if with_region {
            options.crop = self.region.and_then(|region| whole_pixels(region, width, height));
        }
        Some(Request { serial: self.serial, camera: self.camera()?, options })
    }

    /// Asks what lies under a place of the view, in pixels from the upper left.
    pub fn look(&mut self, x: f64, y: f64) {
        if let Some(request) = self.request(false).filter(|_| self.prepared) {
            let y = f64::from(request.options.height) - y;
            self.link.send(Command::Look(Box::new(request), x, y));
        }
    }

    /// Asks for the rays of the pixel at a place of the view.
    pub fn inspect(&mut self, x: f64, y: f64) {
        if let Some(request) = self.request(false).filter(|_| self.prepared) {
            let (column, row) = (x.floor().max(0.0), y.floor().max(0.0));
            self.asked_pixel = [column as u32, row as u32];
            let from_below = f64::from(request.options.height) - row - 0.5;
            self.link.send(Command::Inspect(Box::new(request), column + 0.5, from_below));
        }
    }

    /// Selects shapes.
    pub fn select(&mut self, shapes: Range<u32>) {
        if let Some(document) = &self.document {
            let bounds = document.packed.bounds_of(shapes.clone());
            let name = match shapes.len() {
                1 => document.shape_name(shapes.start),
                count => format!("{count} shapes"),
            };
            self.selection = Some(Selection { shapes, name, bounds });
        }
        self.redraw_lines();
    }

    /// Selects nothing and forgets the rays.
    pub fn clear_selection(&mut self) {
        (self.selection, self.rays) = (None, None);
        self.redraw_lines();
    }

    /// Looks at the next ray, or the one before.
    pub fn step_ray(&mut self, by: isize) {
        if let Some(rays) = &mut self.rays {
            let count = rays.rows.len() as isize;
            let now = rays.chosen.map_or(if by > 0 { -1 } else { count }, |chosen| chosen as isize);
            rays.chosen = usize::try_from((now + by).rem_euclid(count.max(1))).ok();
            self.redraw_lines();
        }
    }

    /// Lays the lines down anew: rays and boxes.
    pub fn redraw_lines(&mut self) {
        let mut lines = Vec::new();
        let size = self.document.as_ref().map_or(1.0, |document| document.packed.bounds.size().length());
        if let Some(selection) = self.selection.as_ref().filter(|_| self.show_bounds) {
            lines.extend(rays::box_lines(&selection.bounds, [255, 150, 0, 255]));
        }
        if let Some(rays) = &self.rays {
            lines.extend(rays::lines(&rays.rows, rays.chosen, size * 0.03));
        }
        if let Some(raster) = &mut self.raster {
            raster.set_lines(&lines);
        }
        self.stale = true;
    }

    /// Changes which shapes are shown, in both pictures.
    pub fn set_hidden(&mut self, change: impl FnOnce(&mut Hidden, u32)) {
        let count = self.document.as_ref().map_or(0, |document| document.shape_count);
        let before = self.hidden.clone();
        change(&mut self.hidden, count);
        if self.hidden == before {
            return;
        }
        if let Some(raster) = &mut self.raster {
            raster.hide(&self.hidden);
        }
        self.link.send(Command::Hide(self.hidden.clone()));
        self.hovered = None;
        self.moved();
    }

    /// Looks at what is selected, or at everything.
    pub fn frame(&mut self) {
        let all = self.document.as_ref().map(|document| document.packed.bounds);
        let bounds = self.selection.as_ref().map(|selection| selection.bounds).or(all);
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1].max(1));
        if let Some(bounds) = bounds {
            self.navigate(|navigator| navigator.frame(&bounds, aspect));
        }
    }

    /// Shows lights and materials as they now are in the document.
    pub fn restyle(&mut self, outcome: Result<(), String>) {
        if let Err(sentence) = outcome {
            self.notice = sentence;
            return;
        }
        let Some(style) = self.document.as_ref().map(|document| document.style.clone()) else { return };
        self.show_style(style);
    }

    fn show_style(&mut self, style: Resolved) {
        if let Some(raster) = &mut self.raster {
            raster.restyle(&style);
        }
        self.link.send(Command::Style(Box::new(style)));
        self.traced = None;
        self.stale = true;
        self.moved = Instant::now();
        self.restart();
    }

    /// The finished picture in the format that a file's name asks for.
    ///
    /// # Errors
    /// Why there is none.
    pub fn encoded(&self, path: &Path) -> Result<Vec<u8>, String> {
        let image = self.traced.as_ref().and_then(|traced| traced.image.as_ref());
        let image = image.ok_or("the picture is not finished: trace it first (T), then save")?;
        let format = Format::from_path(path).map_err(|error| error.to_string())?;
        dotray_image::encode(image, format, &EncodeOptions::default()).map_err(|error| error.to_string())
    }

    /// The texts of the files that were edited, or with the camera changed.
    ///
    /// # Errors
    /// Why they cannot be written.
    pub fn texts_to_write(&mut self, with_camera: bool) -> Result<Vec<(FileId, Vec<u8>)>, String> {
        let camera = self.camera();
        let (Some(document), Some(camera)) = (&self.document, camera) else {
            return Err("there is no scene".to_owned());
        };
        if !document.can_edit() {
            return Err(format!("the file is in the dialect {}: not written back", document.dialect));
        }
        if !with_camera {
            return document.edited_texts().map_err(|error| error.to_string());
        }
        let rounded = edit::rounded_camera(&camera);
        let text = document.sources.bytes(FileId(0));
        let text =
            edit::with_camera(text, document.camera_span(), &rounded).map_err(|error| error.to_string())?;
        if let Some(navigator) = &mut self.navigator {
            navigator.settle(rounded);
        }
        Ok(vec![(FileId(0), text)])
    }

    /// Moves the camera by flying, in parts of the scene's size.
    pub fn fly(&mut self, by: [f64; 3]) {
        self.navigate(|navigator| navigator.fly(Vec3::from_array(by)));
    }
}
