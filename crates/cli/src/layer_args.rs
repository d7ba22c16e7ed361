//! What was typed about what lies behind, beside and over a picture.

use clap::ValueEnum;
use dotray::geometry::Vec3;
use dotray::render::Layer;
use std::path::PathBuf;
use std::str::FromStr;

/// What lies behind everything.
#[derive(Clone, Debug, PartialEq)]
pub enum Background {
    /// A colour in place of the scene's.
    Color(Vec3),
    /// Nothing: the picture has an alpha channel.
    Transparent,
    /// A picture.
    Image(PathBuf),
}

impl FromStr for Background {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "transparent" {
            return Ok(Self::Transparent);
        }
        if let Some(path) = text.strip_prefix("image:").filter(|path| !path.is_empty()) {
            return Ok(Self::Image(PathBuf::from(path)));
        }
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
        let three: Option<[f64; 3]> = numbers.and_then(|numbers| numbers.try_into().ok());
        three
            .map(|rgb| Self::Color(Vec3::from_array(rgb)))
            .ok_or_else(|| "expected a colour such as 0.1,0.2,0.4, or transparent, or image:FILE".to_owned())
    }
}

/// Layers, in the order in which they are typed.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Layers(pub Vec<Layer>);

impl FromStr for Layers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = || Layer::ALL.map(Layer::name).join(", ");
        let mut layers = Vec::new();
        for name in text.split(',').map(str::trim) {
            if name == "all" {
                layers.extend(Layer::ALL);
                continue;
            }
            let layer = Layer::ALL.into_iter().find(|layer| layer.name() == name);
            layers.push(layer.ok_or_else(|| format!("no layer is named `{name}`: all, or {}", known()))?);
        }
        let mut once = Vec::new();
        layers.into_iter().for_each(|layer| {
            if !once.contains(&layer) {
                once.push(layer);
            }
        });
        Ok(Self(once))
    }
}

/// What is drawn over a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Overlay {
    /// The boxes around the scene's groups, as wires
    Bounds,
    /// The boxes (or cells) of the accelerator, as wires
    Accel,
}

impl Overlay {
    /// As it is typed.
    pub fn word(self) -> &'static str {
        match self {
            Self::Bounds => "bounds",
            Self::Accel => "accel",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_become_values() {
        assert_eq!("transparent".parse(), Ok(Background::Transparent));
        assert_eq!("1,0,.5".parse(), Ok(Background::Color(Vec3::new(1.0, 0.0, 0.5))));
        assert_eq!("image:a,b.png".parse(), Ok(Background::Image("a,b.png".into())));
        for wrong in ["", "image:", "1,2", "1,2,3,4", "nan,0,0", "Transparent", "a.png"] {
            assert!(wrong.parse::<Background>().is_err(), "{wrong}");
        }
        assert_eq!("depth,st,depth".parse(), Ok(Layers(vec![Layer::Depth, Layer::St])));
        assert_eq!("st,all".parse::<Layers>().map(|layers| layers.0.len()), Ok(Layer::ALL.len()));
        assert!("depth,hight".parse::<Layers>().unwrap_err().contains("`hight`"));
    }
}
