//! Animations: what a TOML file says about camera and groups, frame by frame. docs/long.md describes it.

use dotray::geometry::Mat4;
use dotray::geometry::Vec3;
use dotray::scene::model::Camera;
use serde::Deserialize;
use std::path::Path;

use crate::curve::Curve;
use crate::curve::Path as Way;
use crate::curve::rotated;
use crate::exit::Failure;

/// An animation.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Animation {
    /// The camera; without it, the scene's stays.
    pub camera: Option<CameraPath>,
    /// Groups that move.
    #[serde(default, rename = "group")]
    pub groups: Vec<GroupPath>,
}

/// The camera's path.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraPath {
    #[serde(default)]
    path: Way,
    #[serde(default, rename = "key")]
    keys: Vec<CameraKey>,
    turntable: Option<Turntable>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKey {
    frame: f64,
    position: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    up: Option<[f64; 3]>,
    half_angle: Option<f64>,
}

/// Turns at a steady pace about an axis through a point.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Turntable {
    #[serde(default)]
    center: [f64; 3],
    #[serde(default = "upwards")]
    axis: [f64; 3],
    #[serde(default)]
    start: f64,
    frames: f64,
    #[serde(default = "one")]
    turns: f64,
}

fn upwards() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn one() -> f64 {
    1.0
}

/// A group's path, within the group's own matrix.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupPath {
    /// The group: a name, or a path of numbers such as 0/2.
    pub group: String,
    #[serde(default)]
    path: Way,
    #[serde(default)]
    pivot: [f64; 3],
    #[serde(default = "upwards")]
    axis: [f64; 3],
    #[serde(default, rename = "key")]
    keys: Vec<GroupKey>,
    turntable: Option<Turntable>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GroupKey {
    frame: f64,
    translate: Option<[f64; 3]>,
    angle: Option<f64>,
    scale: Option<f64>,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// An animation is small: more than this is something else.
const MOST_BYTES: u64 = 16 << 20;

impl Animation {
    /// Reads a file; its text comes along, as a part of what pictures depend on.
    pub fn read(path: &Path) -> Result<(Self, String), Failure> {
        let fault = |error: &dyn std::fmt::Display| Failure::file("read", path, error);
        let length = std::fs::metadata(path).map_err(|error| fault(&error))?.len();
        if length > MOST_BYTES {
            return Err(fault(&format!("it has {length} bytes; an animation has at most {MOST_BYTES}")));
        }
        let text = std::fs::read_to_string(path).map_err(|error| fault(&error))?;
        let animation: Self = toml::from_str(&text).map_err(|error| {
            Failure::Failed(format!("`{}` is no animation: {}", path.display(), error.to_string().trim_end()))
        })?;
        animation.check().map_err(|message| Failure::Failed(format!("`{}`: {message}", path.display())))?;
        Ok((animation, text))
    }

    fn check(&self) -> Result<(), String> {
        let ascending = |what: &str, frames: Vec<f64>| {
            let fine = frames.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
            let finite = frames.iter().all(|frame| frame.is_finite());
            if fine && finite { Ok(()) } else { Err(format!("the frames of the keys of {what} must ascend")) }
        };
        let turns = |what: &str, turntable: &Option<Turntable>| match turntable {
            Some(turn) if turn.frames == 0.0 || !turn.frames.is_finite() || turn.axis == [0.0; 3] => {
                Err(format!("the turntable of {what} needs `frames` above 0 and an axis with a length"))
            }
            Some(_) | None => Ok(()),
        };
        if let Some(camera) = &self.camera {
            ascending("the camera", camera.keys.iter().map(|key| key.frame).collect())?;
            turns("the camera", &camera.turntable)?;
            if camera.keys.iter().any(|key| key.direction.is_some() && key.target.is_some()) {
                return Err("a key of the camera has a direction or a target, not both".to_owned());
            }
            if camera.keys.is_empty() && camera.turntable.is_none() {
                return Err("the camera has neither keys nor a turntable".to_owned());
            }
        }
        for group in &self.groups {
            let what = format!("the group `{}`", group.group);
            ascending(&what, group.keys.iter().map(|key| key.frame).collect())?;
            turns(&what, &group.turntable)?;
            if group.axis == [0.0; 3] {
                return Err(format!("the axis of {what} has no length"));
            }
            if group.keys.iter().any(|key| key.scale.is_some_and(|scale| scale == 0.0)) {
                return Err(format!("a scale of {what} is 0, which flattens everything"));
            }
            if group.keys.is_empty() && group.turntable.is_none() {
                return Err(format!("{what} has neither keys nor a turntable"));
            }
        }
        Ok(())
    }
}

impl Turntable {
    /// The angle at a frame.
    fn angle(&self, frame: f64) -> f64 {
        (frame - self.start) / self.frames * self.turns * 360.0 * DEGREE
    }
}

impl CameraPath {
    /// The camera of a frame; what keys do not say is as in the scene.
    pub fn at(&self, frame: u32, scene: &Camera) -> Result<Camera, String> {
        let time = f64::from(frame);
        let vector = |v: [f64; 3]| Vec3::from_array(v);
        let along = |value: &dyn Fn(&CameraKey) -> Option<Vec3>| {
            let points = self.keys.iter().filter_map(|key| Some((key.frame, value(key)?)));
            Curve::new(self.path, points.collect()).at(time)
        };
        let position = along(&|key| key.position.map(vector)).unwrap_or(scene.position);
        let direction = along(&|key| key.target.map(vector))
            .map(|target| target - position)
            .or_else(|| along(&|key| key.direction.map(vector)))
            .unwrap_or(scene.direction);
        let up = along(&|key| key.up.map(vector)).unwrap_or(scene.up);
        let angles = along(&|key| key.half_angle.map(Vec3::splat));
        let half_angle = angles.map_or(scene.half_angle, |angle| angle.x);
        let mut camera = Camera { position, direction, up, half_angle };
        if let Some(turn) = &self.turntable {
            let (center, angle) = (vector(turn.center), turn.angle(time));
            let about = |v: Vec3| rotated(v, vector(turn.axis), angle);
            camera.position = center + about(position - center);
            camera.direction = about(direction);
            camera.up = about(up);
        }
        check_camera(&camera).map_err(|message| format!("frame {frame}: {message}"))?;
        Ok(camera)
    }
}

fn check_camera(camera: &Camera) -> Result<(), String> {
    let finite = [camera.position, camera.direction, camera.up].iter().all(|v| v.is_finite());
    let right = camera.direction.normalize_or_zero().cross(camera.up.normalize_or_zero());
    if !finite || right.length() < 1e-9 {
        return Err("the camera looks along its own `up`, or nowhere".to_owned());
    }
    if camera.half_angle > 0.0 && camera.half_angle < std::f64::consts::FRAC_PI_2 {
        Ok(())
    } else {
        Err(format!("half_angle is {}; expected above 0 and below pi/2", camera.half_angle))
    }
}

impl GroupPath {
    /// What stands right of the group's own matrix at a frame.
    pub fn at(&self, frame: u32) -> Mat4 {
        let time = f64::from(frame);
        let along = |value: &dyn Fn(&GroupKey) -> Option<Vec3>| {
            let points = self.keys.iter().filter_map(|key| Some((key.frame, value(key)?)));
            Curve::new(self.path, points.collect()).at(time)
        };
        let translation = along(&|key| key.translate.map(Vec3::from_array)).unwrap_or(Vec3::ZERO);
        let angle = along(&|key| key.angle.map(|angle| Vec3::splat(angle * DEGREE))).map_or(0.0, |v| v.x);
        let scale = along(&|key| key.scale.map(Vec3::splat)).map_or(1.0, |v| v.x);
        let pivot = Vec3::from_array(self.pivot);
        let axis = Vec3::from_array(self.axis);
        let turned = |v: Vec3| match &self.turntable {
            Some(turn) => {
                let center = Vec3::from_array(turn.center);
                center + rotated(v - center, Vec3::from_array(turn.axis), turn.angle(time))
            }
            None => v,
        };
        let moved = |v: Vec3| turned(pivot + translation + rotated((v - pivot) * scale, axis, angle));
        // The images of the origin and of the three axes are the matrix.
        let origin = moved(Vec3::ZERO);
        let column = |unit: Vec3| (moved(unit) - origin).extend(0.0);
        Mat4::from_cols(column(Vec3::X), column(Vec3::Y), column(Vec3::Z), origin.extend(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: Camera = Camera { position: Vec3::Z, direction: Vec3::NEG_Z, up: Vec3::Y, half_angle: 0.5 };

    fn animation(text: &str) -> Result<Animation, String> {
        let animation: Animation = toml::from_str(text).map_err(|error| error.to_string())?;
        animation.check().map(|()| animation)
    }

    #[test]
    fn cameras_move_between_keys_and_turn() {
        let text = "[camera]\n[[camera.key]]\nframe = 1\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\n\
                    [[camera.key]]\nframe = 3\nposition = [2, 0, 1]\ntarget = [0, 0, 0]";
        let camera = animation(text).unwrap().camera.unwrap();
        let at = |frame| camera.at(frame, &SCENE).unwrap();
        assert_eq!((at(0).position, at(1).position), (Vec3::Z, Vec3::Z));
        assert_eq!((at(2).position, at(2).direction), (Vec3::new(1.0, 0.0, 1.0), Vec3::new(-1.0, 0.0, -1.0)));
        assert_eq!((at(9).position, at(9).half_angle), (Vec3::new(2.0, 0.0, 1.0), 0.5));
        let camera = animation("[camera.turntable]\nframes = 4").unwrap().camera.unwrap();
        let quarter = camera.at(1, &SCENE).unwrap();
        assert!((quarter.position - Vec3::X).length() < 1e-15, "{quarter:?}");
        assert!((quarter.direction - Vec3::NEG_X).length() < 1e-15, "{quarter:?}");
    }

    #[test]
    fn groups_turn_about_their_pivot() {
        let text = "[[group]]\ngroup = 'arm'\npivot = [1, 0, 0]\naxis = [0, 0, 2]\n\
                    [[group.key]]\nframe = 0\nangle = 0\n\
                    [[group.key]]\nframe = 10\nangle = 90\ntranslate = [0, 0, 5]\nscale = 2";
        let group = animation(text).unwrap().groups.swap_remove(0);
        let end = group.at(10).transform_point3(Vec3::new(2.0, 0.0, 0.0));
        assert!((end - Vec3::new(1.0, 2.0, 5.0)).length() < 1e-14, "{end}");
        let start = group.at(0).transform_point3(Vec3::new(2.0, 0.0, 0.0));
        assert!(
            (start - Vec3::new(1.0, 2.0, 5.0)).length() > 1.0,
            "one key of translate holds for all: {start}"
        );
    }

    #[test]
    fn what_makes_no_sense_is_told() {
        for (text, part) in [
            ("[camera]", "neither keys nor a turntable"),
            ("[camera.turntable]\nframes = 0", "above 0"),
            ("[[camera.key]]\nframe = 2\n[[camera.key]]\nframe = 2", "must ascend"),
            ("[[camera.key]]\nframe = 2\ntarget = [0,0,0]\ndirection = [0,0,1]", "not both"),
            ("[[group]]\ngroup = 'a'\n[[group.key]]\nframe = 1\nscale = 0", "flattens"),
            ("[[group]]\ngroup = 'a'\naxis = [0,0,0]\n[[group.key]]\nframe = 1", "no length"),
            ("[camera]\nspeed = 3", "unknown field `speed`"),
            ("[camera]\npath = 'curly'", "linear"),
        ] {
            assert!(animation(text).unwrap_err().contains(part), "{text}: {:?}", animation(text));
        }
        let camera = animation("[[camera.key]]\nframe = 1\ndirection = [0, 3, 0]").unwrap().camera.unwrap();
        assert!(camera.at(1, &SCENE).unwrap_err().contains("frame 1: the camera looks along"));
    }
}
