//! The clauses of a material's `!string!`: 3-D textures and bumps, as data.
//!
//! The text is a list of clauses separated by `;`. A clause is a known name and then words `key=value`; anything
//! else is free text that other programs use for their own ends, and is passed over without a word.

use dotray_geometry::Vec3;

/// A 3-D texture: `color2 + w * (color - color2)` with the pattern's weight w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Which weight.
    pub pattern: Pattern,
    /// q = scale · p.
    pub scale: f64,
    /// 1 … 30.
    pub octaves: u32,
    /// Where w = 1.
    pub color: Vec3,
    /// Where w = 0.
    pub color2: Vec3,
}

/// The four patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// clamp(½ + ½ fbm(q), 0, 1)
    Noise,
    /// ½ + ½ sin(π (q_x + 2 turb(q)))
    Marble,
    /// frac(√(q_x² + q_z²) + 0.2 fbm(q))
    Wood,
    /// 1 on even cells, 0 on odd ones
    Checker,
}

/// A bump: what leans the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bump {
    /// The slopes of h(p) = height · fbm(scale · p).
    Noise {
        /// Cells a unit.
        scale: f64,
        /// 1 … 30.
        octaves: u32,
        /// The function's size.
        height: f64,
    },
    /// The differences of an image's texels; no clause, but what a dialect's materials may have.
    Image {
        /// The number of a texture of the scene.
        texture: u32,
        /// The slope of a texel that is 1 brighter than its neighbour.
        scale: f64,
    },
}

/// All clauses of one string, in its order, and then the bump image if there is one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Procedural {
    /// Their colours multiply.
    pub solids: Vec<Solid>,
    /// Their gradients add.
    pub bumps: Vec<Bump>,
}

impl Procedural {
    /// Whether there is nothing: neither a texture nor a bump.
    pub const fn is_empty(&self) -> bool {
        self.solids.is_empty() && self.bumps.is_empty()
    }

    /// The numbers of the textures that lean normals.
    pub fn bump_textures(&self) -> impl Iterator<Item = u32> {
        self.bumps.iter().filter_map(|bump| match *bump {
            Bump::Image { texture, .. } => Some(texture),
            Bump::Noise { .. } => None,
        })
    }
}

/// Reads the text between the exclamation marks. The second value holds a warning for each bad key or value; such
/// a word is passed over. Of equal keys the last one counts.
pub fn parse_clauses(text: &str) -> (Procedural, Vec<String>) {
    let mut procedural = Procedural::default();
    let mut warnings = Vec::new();
    for clause in text.split(';') {
        let mut words = clause.split_whitespace();
        let Some(name) = words.next() else { continue };
        if !words.clone().all(|word| word.contains('=')) {
            continue;
        }
        match name {
            "noise" => procedural.solids.push(solid(Pattern::Noise, name, words, &mut warnings)),
            "marble" => procedural.solids.push(solid(Pattern::Marble, name, words, &mut warnings)),
            "wood" => procedural.solids.push(solid(Pattern::Wood, name, words, &mut warnings)),
            "checker" => procedural.solids.push(solid(Pattern::Checker, name, words, &mut warnings)),
            "bump" => procedural.bumps.push(bump(name, words, &mut warnings)),
            _ => {}
        }
    }
    (procedural, warnings)
}

fn solid<'a>(
    pattern: Pattern,
    clause: &str,
    words: impl Iterator<Item = &'a str>,
    warnings: &mut Vec<String>,
) -> Solid {
    let mut solid = Solid { pattern, scale: 1.0, octaves: 4, color: Vec3::ONE, color2: Vec3::ZERO };
    for (key, value) in words.filter_map(|word| word.split_once('=')) {
        let fault = match key {
            "scale" => store(&mut solid.scale, number(value), NUMBER),
            "octaves" => store(&mut solid.octaves, octaves(value), OCTAVES),
            "color" => store(&mut solid.color, color(value), COLOR),
            "color2" => store(&mut solid.color2, color(value), COLOR),
            _ => Some("a known key: `scale`, `octaves`, `color` or `color2`"),
        };
        warn(warnings, clause, key, value, fault);
    }
    solid
}

fn bump<'a>(clause: &str, words: impl Iterator<Item = &'a str>, warnings: &mut Vec<String>) -> Bump {
    let (mut scale, mut count, mut height) = (1.0, 4, 0.1);
    for (key, value) in words.filter_map(|word| word.split_once('=')) {
        let fault = match key {
            "scale" => store(&mut scale, number(value), NUMBER),
            "octaves" => store(&mut count, octaves(value), OCTAVES),
            "height" => store(&mut height, number(value), NUMBER),
            _ => Some("a known key: `scale`, `octaves` or `height`"),
        };
        warn(warnings, clause, key, value, fault);
    }
    Bump::Noise { scale, octaves: count, height }
}

const NUMBER: &str = "a number";
const OCTAVES: &str = "a whole number from 1 to 30";
const COLOR: &str = "three numbers `r,g,b` without blanks";

/// Puts a good value into its place; says what was expected instead of a bad one.
fn store<T>(place: &mut T, value: Option<T>, expected: &'static str) -> Option<&'static str> {
    match value {
        Some(value) => {
            *place = value;
            None
        }
        None => Some(expected),
    }
}

/// Of one text so many warnings are kept: its length must not decide how much memory they take.
const MOST_WARNINGS: usize = 20;

fn warn(warnings: &mut Vec<String>, clause: &str, key: &str, value: &str, fault: Option<&str>) {
    let Some(expected) = fault else { return };
    match warnings.len() {
        MOST_WARNINGS => warnings.push("more bad keys or values are not listed".to_owned()),
        0..MOST_WARNINGS => {
            let [key, value] = [key, value].map(shortened);
            warnings
                .push(format!("`{key}={value}` of the clause `{clause}` is ignored: expected {expected}"));
        }
        _ => {}
    }
}

/// A word cut to a length that a message can hold.
fn shortened(word: &str) -> String {
    const MOST: usize = 40;
    let mut short: String = word.chars().take(MOST).collect();
    if short.len() < word.len() {
        short.push('…');
    }
    short
}

/// A finite decimal number, in the form that numbers have elsewhere in a `.ray` file.
fn number(value: &str) -> Option<f64> {
    let decimal = value.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    value.parse::<f64>().ok().filter(|number| decimal && number.is_finite())
}

fn octaves(value: &str) -> Option<u32> {
    value.parse::<u32>().ok().filter(|octaves| (1..=30).contains(octaves))
}

fn color(value: &str) -> Option<Vec3> {
    let mut channels = value.split(',').map(number);
    let color = Vec3::new(channels.next()??, channels.next()??, channels.next()??);
    channels.next().is_none().then_some(color)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clean(text: &str) -> Procedural {
        let (procedural, warnings) = parse_clauses(text);
        assert!(warnings.is_empty(), "{text}: {warnings:?}");
        procedural
    }

    fn default_solid(pattern: Pattern) -> Solid {
        Solid { pattern, scale: 1.0, octaves: 4, color: Vec3::ONE, color2: Vec3::ZERO }
    }

    #[test]
    fn bare_names_take_the_defaults_in_order() {
        let all = clean("noise;marble ; wood;\n\tchecker;bump");
        let patterns = [Pattern::Noise, Pattern::Marble, Pattern::Wood, Pattern::Checker];
        assert_eq!(all.solids, patterns.map(default_solid));
        assert_eq!(all.bumps, [Bump::Noise { scale: 1.0, octaves: 4, height: 0.1 }]);
    }

    #[test]
    fn every_key_is_read() {
        let all = clean(
            "marble octaves=30 scale=-.5e1 color=1,.5,-2 color2=+1.,0,1e-3; bump height=-2 octaves=1 scale=0",
        );
        let expected = Solid {
            pattern: Pattern::Marble,
            scale: -5.0,
            octaves: 30,
            color: Vec3::new(1.0, 0.5, -2.0),
            color2: Vec3::new(1.0, 0.0, 0.001),
        };
        assert_eq!(all.solids, [expected]);
        assert_eq!(all.bumps, [Bump::Noise { scale: 0.0, octaves: 1, height: -2.0 }]);
    }

    #[test]
    fn octaves_of_a_checker_are_accepted_without_a_word() {
        assert_eq!(
            clean("checker octaves=7").solids,
            [Solid { octaves: 7, ..default_solid(Pattern::Checker) }]
        );
    }

    #[test]
    fn anything_else_is_free_text() {
        for text in [
            "",
            ";;",
            "polished",
            "noise of the sea",
            "noise scale=2 loud",
            "noise scale = 2",
            "Noise scale=2",
            "scale=2 noise",
            "over two words",
            "noise:scale=2",
            "perlin scale=x",
        ] {
            assert_eq!(clean(text), Procedural::default(), "{text}");
        }
        assert_eq!(clean("polished; wood ; by the yard").solids, [default_solid(Pattern::Wood)]);
    }

    #[test]
    fn the_last_good_value_of_equal_keys_counts() {
        assert_eq!(clean("wood scale=2 scale=3").solids[0].scale, 3.0);
        let (procedural, warnings) = parse_clauses("wood scale=2 scale=x");
        assert_eq!(procedural.solids[0].scale, 2.0);
        assert_eq!(warnings, ["`scale=x` of the clause `wood` is ignored: expected a number"]);
    }

    #[test]
    fn bad_words_are_warned_of_and_ignored() {
        for word in [
            "scale=nan",
            "scale=inf",
            "scale=-infinity",
            "scale=1e999",
            "scale=0x10",
            "scale=",
            "scale==2",
            "=2",
            "octaves=0",
            "octaves=31",
            "octaves=2.5",
            "octaves=-1",
            "color=1,2",
            "color=1,2,3,4",
            "color=1,,3",
            "color2=1,2,nan",
            "colour=1,0,0",
            "Scale=2",
            "height=1",
        ] {
            let (procedural, warnings) = parse_clauses(&format!("noise {word} octaves=4"));
            assert_eq!(procedural.solids, [default_solid(Pattern::Noise)], "{word}");
            assert_eq!(warnings.len(), 1, "{word}: {warnings:?}");
            assert!(warnings[0].contains(&format!("`{word}`")), "{word}: {warnings:?}");
        }
        let (procedural, warnings) = parse_clauses("bump color=1,1,1 height=2");
        assert!(matches!(procedural.bumps[0], Bump::Noise { height: 2.0, .. }));
        assert_eq!(warnings.len(), 1);
    }

    #[test]
    fn warnings_take_bounded_memory() {
        let long = "x".repeat(1000);
        let (_, warnings) = parse_clauses(&format!("wood {}", format!("scale={long} ").repeat(1000)));
        assert_eq!(warnings.len(), 21);
        assert!(warnings[0].len() < 150, "{}", warnings[0]);
        assert_eq!(warnings[20], "more bad keys or values are not listed");
    }
}
