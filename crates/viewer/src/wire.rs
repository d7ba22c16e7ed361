//! What a screen and a tracer tell each other where they are not in one process: messages, and the bytes of messages.

use crate::engine::Part;
use crate::engine::Request;
use crate::engine::Seen;
use crate::engine::Share;
use crate::hidden::Hidden;
use crate::rays::RayRow;
use dotray_geometry::Vec3;
use dotray_render::TilePixels;
use dotray_render::progress::Advance;
use dotray_scene::Resolved;
use dotray_scene::model::Light;
use dotray_scene::resolved::ResolvedMaterial;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use serde::Deserialize;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::Read;
use std::io::Write;

/// What a screen tells a tracer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Ask {
    /// Prepares a scene.
    Open {
        /// Told apart from other scenes by this number.
        number: u64,
        /// Its file.
        path: String,
        /// The accelerator's name.
        accel: String,
        /// What the scene is made of; nothing where the tracer has it already.
        files: Vec<(String, Vec<u8>)>,
    },
    /// Other lights, materials and colours of the same scene.
    Style(Box<Style>),
    /// Leaves these shapes out, and no other.
    Hide(Hidden),
    /// Traces a picture; the one under way is dropped.
    Draw(Box<Request>),
    /// Drops the picture under way.
    Stop,
    /// What lies under a place of the picture.
    Look(Box<Request>, f64, f64),
    /// All rays of a place of the picture.
    Inspect(Box<Request>, f64, f64),
    /// The last picture is on the screen: there may be another.
    Shown,
    /// Stores a file of the scene.
    Store(String, Vec<u8>),
    /// Traces tiles of a picture that another tracer puts together.
    Help(Box<Share>),
    /// Stops for a moment: a hand does something that may move the camera.
    Hold,
    /// Goes on.
    GoOn,
}

/// What a tracer tells a screen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Tell {
    /// A scene to show, with all that it is made of.
    Scene {
        /// Its file.
        path: String,
        /// The files by the names under which the scene asks for them.
        files: Vec<(String, Vec<u8>)>,
    },
    /// The scene of this number can be traced, after so many seconds.
    Prepared(u64, f64),
    /// The scene of this number cannot be traced.
    Failed(u64, Vec<String>),
    /// A picture.
    Picture(Box<Sent>),
    /// What lies under a place.
    Seen(Option<Seen>),
    /// The rays of a place.
    Rays(Vec<RayRow>),
    /// The request makes no sense; the sentence says why.
    Refused(String),
    /// Something that the user should know.
    Notice(String),
    /// How many tracers have the scene of this number.
    Tracers(u64, usize),
    /// Tiles for the tracer that has asked for help.
    Part(Box<SentPart>),
}

/// Tiles on their way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SentPart {
    /// Of which request.
    pub serial: u64,
    /// How many of the coarse looks were done.
    pub looks: usize,
    /// The bytes of the tiles.
    pub tiles: Vec<Vec<u8>>,
    /// Whether these are the last ones of their share.
    pub ended: bool,
}

impl SentPart {
    /// Of these tiles.
    pub fn of(part: &Part) -> Self {
        let Part { serial, looks, tiles, ended } = part;
        let tiles = tiles.iter().map(TilePixels::to_bytes).collect();
        Self { serial: *serial, looks: *looks, tiles, ended: *ended }
    }

    /// The tiles, as far as they have come whole.
    pub fn part(&self) -> Part {
        let tiles = self.tiles.iter().filter_map(|bytes| TilePixels::from_bytes(bytes)).collect();
        Part { serial: self.serial, looks: self.looks, tiles, ended: self.ended }
    }
}

/// A picture on its way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sent {
    /// Whose.
    pub serial: u64,
    /// Columns and rows.
    pub size: [u32; 2],
    /// The pixels, or by which bits they differ from those that were sent before.
    pub pixels: Vec<u8>,
    /// Whether it is the difference.
    pub differs: bool,
    /// How far it has come since the request came: the record `progress` of docs/progress.md.
    pub progress: Advance,
    /// The finished picture: samples of its channels in the machine's own order of bytes, which is the same everywhere.
    pub film: Option<Vec<u8>>,
}

impl Sent {
    /// Keeps the bits that differ from the picture sent before, which packs to almost nothing.
    pub fn against(mut self, before: &Sent) -> Self {
        let same = self.serial == before.serial && self.pixels.len() == before.pixels.len();
        if same && !self.differs {
            mix(&mut self.pixels, &before.pixels);
            self.differs = true;
        }
        self
    }

    /// The picture itself, from what differs from the one that came before.
    pub fn whole(mut self, before: &[u8]) -> Self {
        if std::mem::take(&mut self.differs) {
            mix(&mut self.pixels, before);
        }
        self
    }
}

fn mix(pixels: &mut [u8], others: &[u8]) {
    pixels.iter_mut().zip(others).for_each(|(pixel, other)| *pixel ^= other);
}

/// What can be edited of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Style {
    colors: [Vec3; 3],
    lights: Vec<Light>,
    materials: Vec<[Vec3; 7]>,
    weights: Vec<[f64; 2]>,
}

impl Style {
    /// Of this scene.
    pub fn of(style: &Resolved) -> Self {
        let colors = |it: &ResolvedMaterial| {
            [it.ambient, it.diffuse, it.specular, it.emissive, it.reflection, it.transmission, it.shadow]
        };
        Self {
            colors: [style.background, style.secondary_background, style.ambient],
            lights: style.lights.clone(),
            materials: style.materials.iter().map(colors).collect(),
            weights: style.materials.iter().map(|it| [it.shininess, it.index_of_refraction]).collect(),
        }
    }

    /// A scene with it; `None` where it is another's.
    pub fn put_on(&self, old: &Resolved) -> Option<Resolved> {
        let mut style = old.clone();
        let count = style.materials.len();
        if self.materials.len() != count
            || self.weights.len() != count
            || self.lights.len() != style.lights.len()
        {
            return None;
        }
        [style.background, style.secondary_background, style.ambient] = self.colors;
        style.lights.clone_from(&self.lights);
        let numbers = self.materials.iter().zip(&self.weights);
        for (material, (colors, weights)) in style.materials.iter_mut().zip(numbers) {
            [
                material.ambient,
                material.diffuse,
                material.specular,
                material.emissive,
                material.reflection,
                material.transmission,
                material.shadow,
            ] = *colors;
            [material.shininess, material.index_of_refraction] = *weights;
        }
        Some(style)
    }
}

/// Bytes that a message may have, unpacked: scenes with their textures, large pictures.
pub const MOST: usize = 1 << 30;

/// From so many bytes on a message is packed where it goes over a wire.
const WORTH_PACKING: usize = 4096;

/// The bytes of a message.
pub fn bytes<T: Serialize>(message: &T) -> Vec<u8> {
    // Writing these types into memory cannot fail; where it did, the empty message would be refused.
    postcard::to_stdvec(message).unwrap_or_default()
}

/// The message of these bytes.
///
/// # Errors
/// That they are none.
pub fn message<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    postcard::from_bytes(bytes).map_err(|fault| format!("not a message: {fault}"))
}

/// Bytes for a wire: one that says whether the others are packed, and the others.
pub fn packed(bytes: &[u8]) -> Vec<u8> {
    if bytes.len() >= WORTH_PACKING {
        let mut encoder = ZlibEncoder::new(vec![1], Compression::fast());
        if encoder.write_all(bytes).is_ok()
            && let Ok(packed) = encoder.finish()
        {
            return packed;
        }
    }
    [&[0], bytes].concat()
}

/// Bytes from a wire.
///
/// # Errors
/// That they are not as [`packed`] makes them, or too many.
pub fn unpacked(bytes: &[u8]) -> Result<Vec<u8>, String> {
    match bytes.split_first() {
        Some((0, rest)) => Ok(rest.to_vec()),
        Some((1, rest)) => {
            let mut whole = Vec::new();
            let read = ZlibDecoder::new(rest).take(MOST as u64 + 1).read_to_end(&mut whole);
            match read {
                Ok(_) if whole.len() <= MOST => Ok(whole),
                Ok(_) => Err(format!("a message has more than {MOST} bytes")),
                Err(fault) => Err(format!("a message cannot be unpacked: {fault}")),
            }
        }
        _ => Err("not a message".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_back_as_they_went() {
        let request = Request {
            serial: 7,
            camera: camera(),
            options: dotray_render::Options { threshold: 0.1 + 0.2, ..Default::default() },
        };
        let ask = Ask::Look(Box::new(request), 1.0 / 3.0, -0.0);
        let wire = packed(&bytes(&ask));
        assert_eq!(message::<Ask>(&unpacked(&wire).unwrap()).unwrap(), ask);
        for seconds_left in [None, Some(0.1 + 0.2)] {
            let progress = Advance {
                seconds: 1.5,
                finished_pixels: 7,
                total_pixels: u64::MAX,
                pixels_per_second: 1.0 / 3.0,
                seconds_left,
            };
            let tell = Tell::Picture(Box::new(Sent { serial: 7, progress, ..Sent::default() }));
            assert_eq!(message::<Tell>(&bytes(&tell)).unwrap(), tell);
        }
        let tell = Tell::Notice("x".repeat(100_000));
        let wire = packed(&bytes(&tell));
        assert!(wire.len() < 2000);
        assert_eq!(message::<Tell>(&unpacked(&wire).unwrap()).unwrap(), tell);
    }

    fn camera() -> dotray_scene::model::Camera {
        let (position, direction, up) = (Vec3::new(0.1, 1e300, -7.25), Vec3::X, Vec3::Y);
        dotray_scene::model::Camera { position, direction, up, half_angle: 0.4 }
    }

    #[test]
    fn what_is_no_message_is_refused() {
        assert!(unpacked(&[]).is_err());
        assert!(unpacked(&[2, 1]).is_err());
        assert!(unpacked(&[1, 1, 2, 3]).is_err());
        assert!(message::<Ask>(&[]).is_err());
        assert!(message::<Ask>(&[200, 1]).is_err());
        // A list that claims to be longer than memory is long.
        assert!(message::<Tell>(&[5, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1]).is_err());
    }

    #[test]
    fn a_bomb_is_not_unpacked() {
        let mut encoder = ZlibEncoder::new(vec![1], Compression::fast());
        let zeros = vec![0; 1 << 20];
        (0..1025).for_each(|_| encoder.write_all(&zeros).unwrap());
        assert!(unpacked(&encoder.finish().unwrap()).unwrap_err().contains("more than"));
    }

    #[test]
    fn differences_give_the_picture_back() {
        let before = Sent { serial: 3, pixels: vec![1, 2, 3, 4], ..Sent::default() };
        let now = Sent { serial: 3, pixels: vec![1, 2, 200, 4], ..Sent::default() };
        let sent = now.clone().against(&before);
        assert_eq!((sent.pixels.as_slice(), sent.differs), (&[0, 0, 203, 0][..], true));
        assert_eq!(sent.whole(&before.pixels), now);
        let other = Sent { serial: 4, ..before.clone() };
        assert_eq!(other.clone().against(&before), other);
    }
}
