//! The one table of directives from which parser, writer, help and format page are made.

mod foreign;
mod page;
mod table;

pub use foreign::find_in;
pub use foreign::find_in_any_dialect;
pub use foreign::words_of;
pub use page::format_page;
pub use table::DIRECTIVES;

use crate::dialect::Dialect;

/// A directive of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Directive {
    /// `#camera`
    Camera,
    /// `#background`
    Background,
    /// `#ambient`
    Ambient,
    /// `#light_num`
    LightNum,
    /// `#light_point`
    LightPoint,
    /// `#light_spot`
    LightSpot,
    /// `#light_dir`
    LightDir,
    /// `#light_area`
    LightArea,
    /// `#texture_num`
    TextureNum,
    /// `#texture`
    Texture,
    /// `#material_num`
    MaterialNum,
    /// `#material`
    Material,
    /// `#group_begin`
    GroupBegin,
    /// `#group_end`
    GroupEnd,
    /// `#shape_sphere`
    ShapeSphere,
    /// `#shape_box`
    ShapeBox,
    /// `#shape_cylinder`
    ShapeCylinder,
    /// `#shape_cone`
    ShapeCone,
    /// `#shape_side`
    ShapeSide,
    /// `#shape_triangle`
    ShapeTriangle,
    /// `#vertex_num`
    VertexNum,
    /// `#vertex`
    Vertex,
    /// `#ray_file_num`
    RayFileNum,
    /// `#ray_file`
    RayFile,
    /// `#ray_file_instance`
    RayFileInstance,
    /// `uva`: `#joint_begin`
    JointBegin,
    /// `uva`: `#joint_end`
    JointEnd,
    /// `uva`: `#key_file`
    KeyFile,
    /// `jhu`: `#static_affine`
    StaticAffine,
    /// `jhu`: `#shape_list_begin`
    ListBegin,
    /// `jhu`: `#shape_list_end`
    ListEnd,
    /// `jhu`: `#shape_triangles`
    Triangles,
    /// `jhu`: `#shape_torus`; `hmc`: `#torus`
    ShapeTorus,
    /// `hmc`: `#version`
    Version,
    /// `hmc`: `#rayfile_end`
    RayfileEnd,
    /// `hmc`: `#translate`
    Translate,
    /// `hmc`: `#rotate`
    Rotate,
    /// `hmc`: `#scale`
    Scale,
    /// `unisa`: `#shader`
    Shader,
}

/// What kind of token an argument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArgumentKind {
    /// A decimal number.
    Number,
    /// A whole number.
    Integer,
    /// A word, or "quoted" where it holds blanks.
    Name,
    /// `!…!`
    Text,
}

/// Arguments that follow each other and mean one thing, such as the three coordinates of a point.
#[derive(Clone, Copy, Debug)]
pub struct Arguments {
    /// Their names.
    pub names: &'static [&'static str],
    /// What kind of token each is.
    pub kind: ArgumentKind,
    /// The unit of numbers; empty where they have none.
    pub unit: &'static str,
    /// What they mean.
    pub meaning: &'static str,
}

/// One way to write a directive.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The arguments, in order.
    pub arguments: &'static [Arguments],
    /// How many tokens they are.
    pub count: usize,
    /// Whether all of them are numbers.
    pub numeric: bool,
    /// A whole directive as one may write it.
    pub example: &'static str,
}

/// Where a directive comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The lecture slides that define the language.
    Slides,
    /// Later courses.
    LaterCourses,
    /// This project.
    Dotray,
}

/// All that is known of a directive.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// Which one.
    pub directive: Directive,
    /// The word, with its `#`.
    pub word: &'static str,
    /// What it means, in one sentence.
    pub meaning: &'static str,
    /// Who brought it in.
    pub origin: Origin,
    /// The ways to write it, told apart by the number of arguments.
    pub forms: &'static [Form],
}

impl Form {
    /// The name, kind and group of each argument.
    pub fn each(&self) -> impl Iterator<Item = (&'static str, &'static Arguments)> {
        self.arguments.iter().flat_map(|group| group.names.iter().map(move |name| (*name, group)))
    }

    /// The places of the first argument of each group that is written apart: three points are three groups, and
    /// neighbours that mean something each by themselves, such as radius and height, are one.
    pub fn group_starts(&self) -> Vec<usize> {
        let mut starts = Vec::new();
        let (mut place, mut single_before) = (0, false);
        for group in self.arguments {
            let count = group.names.len();
            let step = match count {
                9 => 3,
                6 => 2,
                other => other.max(1),
            };
            if !(count == 1 && single_before) {
                starts.extend((place..place + count).step_by(step));
            }
            place += count;
            single_before = count == 1;
        }
        starts
    }

    /// All names with blanks between, `!…!` around a text.
    pub fn usage(&self) -> String {
        let words = self.each().map(|(name, group)| match group.kind {
            ArgumentKind::Number | ArgumentKind::Integer | ArgumentKind::Name => name.to_owned(),
            ArgumentKind::Text => format!("!{name}!"),
        });
        words.collect::<Vec<_>>().join(" ")
    }
}

impl Spec {
    /// The form with `count` arguments.
    pub fn form(&self, count: usize) -> Option<&'static Form> {
        self.forms.iter().find(|form| form.count == count)
    }

    /// Whether all arguments of all forms are numbers.
    #[inline]
    pub fn is_numeric(&self) -> bool {
        self.forms.iter().all(|form| form.numeric)
    }
}

/// The most arguments that any directive takes.
pub const MAX_ARGUMENTS: usize = 25;

const SLOTS: usize = 64;

/// The numbers of the directives plus 1 by the hash of their words; 0 is an empty slot, a taken one leads to the next.
static SLOT: [u8; SLOTS] = {
    let mut slots = [0; SLOTS];
    let mut number = 0;
    while number < DIRECTIVES.len() {
        let mut slot = hash(DIRECTIVES[number].word.as_bytes());
        while slots[slot] != 0 {
            slot = (slot + 1) % SLOTS;
        }
        slots[slot] = number as u8 + 1;
        number += 1;
    }
    slots
};

/// Length, last letter and the ninth tell nearly all words apart.
const fn hash(word: &[u8]) -> usize {
    let last = if word.is_empty() { 0 } else { word[word.len() - 1] };
    let ninth = if word.len() > 8 { word[8] } else { 0 };
    (word.len() + 5 * last as usize + 11 * ninth as usize) % SLOTS
}

/// The directive of this very word (with its `#`, in lower case).
#[inline]
pub fn find(word: &[u8]) -> Option<&'static Spec> {
    let mut slot = hash(word);
    loop {
        let number = usize::from(*SLOT.get(slot)?).checked_sub(1)?;
        let spec = DIRECTIVES.get(number)?;
        if spec.word.as_bytes() == word {
            return Some(spec);
        }
        slot = (slot + 1) % SLOTS;
    }
}

/// The directive of this word in any letter case.
pub fn find_in_any_case(word: &[u8]) -> Option<&'static Spec> {
    DIRECTIVES.iter().find(|spec| spec.word.as_bytes().eq_ignore_ascii_case(word))
}

/// The entry of a directive.
pub fn spec(directive: Directive) -> &'static Spec {
    // The table stands in the order of the enum, which a test holds.
    &DIRECTIVES[directive as usize]
}

/// The directive of the slides whose name is nearest to an unknown word, if one is near.
pub fn suggest(word: &[u8]) -> Option<&'static Spec> {
    suggest_in(Dialect::Slides, word)
}

/// The directive of a dialect whose name is nearest to an unknown word, if one is near.
pub fn suggest_in(dialect: Dialect, word: &[u8]) -> Option<&'static Spec> {
    const LONGEST: usize = 40;
    if word.len() > LONGEST {
        return None;
    }
    let lower = word.to_ascii_lowercase();
    let near = (lower.len() / 3).clamp(1, 4);
    let distances = words_of(dialect).map(|spec| (edit_distance(&lower, spec.word.as_bytes()), spec));
    let nearest = distances.min_by_key(|(distance, _)| *distance);
    // `#sphere` is far from `#shape_sphere` in letters, but not to a person.
    let stem = lower.strip_prefix(b"#").filter(|stem| stem.len() > 2);
    let whole =
        |spec: &&Spec| stem.is_some_and(|stem| spec.word.as_bytes().ends_with(&[b"_", stem].concat()));
    match nearest {
        Some((distance, spec)) if distance <= near => Some(spec),
        Some(_) | None => words_of(dialect).find(whole),
    }
}

/// How many letters must be put in, left out, changed or swapped with their neighbour to get from one to the other.
pub(crate) fn edit_distance(from: &[u8], to: &[u8]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=to.len()).collect();
    let mut above = 0;
    for (row, &a) in from.iter().enumerate() {
        let mut next = vec![row + 1];
        let mut left = 0;
        for (column, &b) in to.iter().enumerate() {
            let changed = last[column] + usize::from(a != b);
            let mut cost = changed.min(last[column + 1] + 1).min(next[column] + 1);
            if row > 0 && column > 0 && a == left && b == above {
                cost = cost.min(before[column - 1] + 1);
            }
            next.push(cost);
            left = b;
        }
        above = a;
        before = std::mem::replace(&mut last, next);
    }
    last[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_the_order_of_the_enum() {
        for (number, entry) in DIRECTIVES.iter().enumerate() {
            assert_eq!(entry.directive as usize, number, "{}", entry.word);
            assert_eq!(spec(entry.directive).word, entry.word);
        }
    }

    #[test]
    fn every_word_is_found_and_no_other() {
        for entry in &DIRECTIVES {
            assert_eq!(find(entry.word.as_bytes()).map(|found| found.word), Some(entry.word));
            assert!(find(entry.word.to_uppercase().as_bytes()).is_none());
            assert!(find_in_any_case(entry.word.to_uppercase().as_bytes()).is_some());
        }
        for word in ["", "#", "#shape", "#shape_spherf", "shape_sphere", "#shape_spheree"] {
            assert!(find(word.as_bytes()).is_none(), "{word}");
        }
    }

    #[test]
    fn counts_are_those_of_the_names() {
        for entry in &DIRECTIVES {
            for form in entry.forms {
                assert_eq!(form.count, form.each().count(), "{}", entry.word);
                assert!(form.count <= MAX_ARGUMENTS);
            }
        }
    }

    #[test]
    fn the_examples_stand_in_their_groups() {
        for entry in &DIRECTIVES {
            for form in entry.forms.iter().filter(|form| form.numeric && form.count > 0) {
                let (_, arguments) = form.example.split_once(' ').unwrap();
                let mut starts = vec![0];
                for group in arguments.split("  ") {
                    starts.push(starts.last().unwrap() + group.split(' ').count());
                }
                starts.pop();
                assert_eq!(form.group_starts(), starts, "{}", form.example);
            }
        }
    }

    #[test]
    fn near_names_are_suggested() {
        let cases = [
            ("#shape_spere", Some("#shape_sphere")),
            ("#sphere_shape", None),
            ("#ligth_dir", Some("#light_dir")),
            ("#Camrea", Some("#camera")),
            ("#x", None),
            ("#group_start", None),
            ("#groupbegin", Some("#group_begin")),
            ("#Sphere", Some("#shape_sphere")),
            ("#box", Some("#shape_box")),
            ("#end", Some("#group_end")),
            ("#include", None),
        ];
        for (word, nearest) in cases {
            assert_eq!(suggest(word.as_bytes()).map(|spec| spec.word), nearest, "{word}");
        }
    }

    #[test]
    fn distance_counts_swaps_once() {
        for (from, to, distance) in [
            ("", "abc", 3),
            ("abc", "abc", 0),
            ("acb", "abc", 1),
            ("abd", "abc", 1),
            ("kitten", "sitting", 3),
        ] {
            assert_eq!(edit_distance(from.as_bytes(), to.as_bytes()), distance, "{from} {to}");
        }
    }
}
