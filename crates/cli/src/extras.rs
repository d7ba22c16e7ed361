//! What a picture gets besides its colours: what lies behind, beside and over it.

use dotray::Image;
use dotray::image::Format;
use dotray::image::encode;
use dotray::image::encode_exr_layers;
use dotray::render::Fingerprint;
use dotray::render::LayerPicture;
use dotray::render::World;
use dotray::scene::Resolved;
use dotray::scene::Sources;
use std::path::PathBuf;
use std::sync::Arc;

use crate::background;
use crate::background::Back;
use crate::exit::Failure;
use crate::layer_args::Background;
use crate::layer_args::Overlay;
use crate::layers;
use crate::meaning::Place;
use crate::output;
use crate::overlay;
use crate::overlay::Wire;
use crate::plan::Plan;
use crate::tree::Tree;

/// What must be known before the scene is baked.
pub struct Extras {
    back: Option<Arc<Back>>,
    wires: Vec<Wire>,
}

/// Reads the picture that lies behind, where there is one.
pub fn back(plan: &Plan) -> Result<Option<Arc<Back>>, Failure> {
    match &plan.background {
        None | Some(Background::Transparent | Background::Color(_)) => Ok(None),
        Some(Background::Image(path)) => {
            background::load(path, &plan.prepare.image_limits).map(|back| Some(Arc::new(back)))
        }
    }
}

impl Extras {
    /// Puts the background into the scene, and finds the boxes that are to be drawn.
    pub fn new(
        plan: &Plan,
        resolved: &mut Resolved,
        sources: &Sources,
        back: Option<Arc<Back>>,
    ) -> Result<Self, Failure> {
        if let Some(Background::Color(color)) = plan.background {
            (resolved.background, resolved.secondary_background) = (color, color);
        }
        for path in layer_paths(plan) {
            output::check(&Place::File(path), &plan.input)?;
        }
        let wires = match plan.overlay {
            // The accelerator is not there yet.
            None | Some(Overlay::Accel) => Vec::new(),
            Some(Overlay::Bounds) => overlay::group_wires(&Tree::new(resolved, sources)),
        };
        Ok(Self { back, wires })
    }

    /// What a picture depends on, with what lies behind, beside and over it.
    pub fn added_to(&self, fingerprint: Fingerprint, plan: &Plan) -> Fingerprint {
        let mut all = layers::with_layers(fingerprint, &plan.layers);
        if let Some(back) = &self.back {
            all = back.added_to(all);
        }
        let drawn = match plan.overlay {
            None => return all,
            Some(Overlay::Bounds) => Overlay::Bounds.word().to_owned(),
            // Its boxes are seen, so that it does matter which it is.
            Some(Overlay::Accel) => {
                let (accel, build) = (plan.prepare.accel.name(), plan.build.word());
                format!("{} ({accel}, {build})", Overlay::Accel.word())
            }
        };
        all = all.with("overlay", &drawn);
        match plan.overlay_levels {
            usize::MAX => all,
            levels => all.with("overlay levels", &levels.to_string()),
        }
    }

    /// The picture with what lies behind and over it.
    pub fn apply(&self, image: Image, world: &World, plan: &Plan) -> Result<Image, Failure> {
        let mut image = match &self.back {
            Some(back) => background::composed(&image, &back.image, &plan.options)?,
            None => image,
        };
        let accelerator = match plan.overlay {
            None | Some(Overlay::Bounds) => Vec::new(),
            Some(Overlay::Accel) => overlay::accelerator_wires(world.caster()),
        };
        let wires = self.wires.iter().chain(&accelerator);
        let wires = wires.filter(|wire| wire.depth < plan.overlay_levels);
        overlay::draw(&mut image, wires, world.camera(), &plan.options);
        Ok(image)
    }
}

/// The files of the layers that do not go into the picture's own.
fn layer_paths(plan: &Plan) -> Vec<PathBuf> {
    match (&plan.output, plan.format) {
        (Place::File(path), format) if format != Format::Exr => {
            plan.layers.iter().map(|&layer| layers::path_of(path, layer)).collect()
        }
        (Place::File(_) | Place::Standard, _) => Vec::new(),
    }
}

/// The bytes of the picture's file, and those of further files.
pub struct Encoded {
    /// The picture.
    pub picture: Vec<u8>,
    /// Its layers, if they have files of their own.
    pub layers: Vec<(PathBuf, Vec<u8>)>,
}

/// Encodes the picture and its layers.
pub fn encoded(image: &Image, layers: Vec<LayerPicture>, plan: &Plan) -> Result<Encoded, Failure> {
    if plan.format == Format::Exr && !layers.is_empty() {
        let picture = encode_exr_layers(image, layers::channels(layers))?;
        return Ok(Encoded { picture, layers: Vec::new() });
    }
    let picture = encode(image, plan.format, &plan.encode)?;
    let file = |(path, layer): (PathBuf, &LayerPicture)| Ok((path, layers::png(layer)?));
    let layers = layer_paths(plan).into_iter().zip(&layers).map(file).collect::<Result<Vec<_>, Failure>>()?;
    Ok(Encoded { picture, layers })
}
