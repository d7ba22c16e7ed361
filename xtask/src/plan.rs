//! What is measured in a whole run and in a quick one.

use crate::files;

/// A part of the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Whole programs, text to picture.
    Images,
    /// Rates of rays and builds.
    Rays,
    /// Reading.
    Parse,
    /// Pictures from memory.
    Memory,
    /// Pictures from arrays of numpy.
    Python,
}

impl Part {
    /// All, in their order.
    pub const ALL: [Self; 5] = [Self::Images, Self::Rays, Self::Parse, Self::Memory, Self::Python];

    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Images => "images",
            Self::Rays => "rays",
            Self::Parse => "parse",
            Self::Memory => "memory",
            Self::Python => "python",
        }
    }

    /// The scenes of a whole run.
    fn scenes(self) -> Vec<&'static str> {
        let own: &[&str] = match self {
            Self::Images => &[
                "rnd5", "rnd6", "rnd7", "pack6", "mirrors4", "knot0", "knot2", "knots2", "cyl5", "cone5",
                "box5",
            ],
            Self::Rays => {
                &["rnd3", "rnd5", "rnd6", "rnd7", "pack6", "cyl5", "cyl6", "cone5", "box5", "knot0", "knot2"]
            }
            Self::Parse => &["rnd6", "rnd7", "knot2"],
            Self::Memory => &["rnd6", "pack6"],
            Self::Python => &["rnd7"],
        };
        let (before, after): (&[&str], &[&str]) = match self {
            Self::Images => (&files::DATABASES, &files::SCANS),
            Self::Rays => (&[], &files::SCANS),
            Self::Parse | Self::Memory | Self::Python => (&[], &[]),
        };
        [before, own, after].concat()
    }

    /// The scenes of a quick run.
    const fn quick_scenes(self) -> &'static [&'static str] {
        match self {
            Self::Images => &["mirrors4", "rnd4", "knot0", "cyl4"],
            Self::Rays => &["rnd4", "cyl4", "cone4", "box4", "knot0"],
            Self::Parse | Self::Memory | Self::Python => &["rnd5"],
        }
    }
}

/// What a run does.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The parts and their scenes.
    pub parts: Vec<(Part, Vec<String>)>,
    /// How often each program runs.
    pub rounds: usize,
    /// Whether every part that is run is run in full.
    pub whole: bool,
}

impl Plan {
    /// The plan of a command line: `only` names parts or scenes; a scene that belongs to no part of the plan is taken
    /// into all that can have it.
    ///
    /// # Errors
    /// Where a name is neither a part nor a scene.
    pub fn new(quick: bool, only: &[String], rounds: Option<usize>) -> Result<Self, String> {
        let scenes_of = |part: Part| if quick { part.quick_scenes().to_vec() } else { part.scenes() };
        let part_names: Vec<_> =
            Part::ALL.into_iter().filter(|part| only.iter().any(|o| o == part.name())).collect();
        let scene_names: Vec<&String> =
            only.iter().filter(|name| Part::ALL.iter().all(|part| part.name() != *name)).collect();
        if let Some(name) = scene_names.iter().find(|name| !files::is_shared(name) && !known(name)) {
            let parts = Part::ALL.map(Part::name).join(", ");
            return Err(format!("--only {name}: neither a part ({parts}) nor a scene (see docs/bench.md)"));
        }
        let mut parts = Vec::new();
        for part in Part::ALL {
            if !part_names.is_empty() && !part_names.contains(&part) {
                continue;
            }
            // A wheel is built for it, which is not quick.
            if part == Part::Python && quick && part_names.is_empty() {
                continue;
            }
            let all = scenes_of(part);
            let planned = |name: &str| Part::ALL.into_iter().any(|part| scenes_of(part).contains(&name));
            let fits = |name: &str| all.contains(&name) || !planned(name) || !part_names.is_empty();
            let scenes: Vec<String> = if scene_names.is_empty() {
                all.iter().map(|name| (*name).to_owned()).collect()
            } else {
                scene_names
                    .iter()
                    .filter(|name| fits(name) && can_have(part, name))
                    .map(|n| (*n).clone())
                    .collect()
            };
            if !scenes.is_empty() {
                parts.push((part, scenes));
            }
        }
        let whole = !quick && scene_names.is_empty();
        Ok(Self { parts, rounds: rounds.unwrap_or(if quick { 1 } else { 3 }).max(1), whole })
    }
}

/// Whether a part can measure a scene.
fn can_have(part: Part, name: &str) -> bool {
    match part {
        Part::Images | Part::Parse => true,
        // Rays start from the unit cube, which the databases' scenes do not fill.
        Part::Rays => !files::DATABASES.contains(&name),
        Part::Python => name.starts_with("rnd"),
        Part::Memory => !files::is_shared(name) && crate::scenes::raw_kind(name) == Some("sph"),
    }
}

/// Whether the catalogue has a scene; cheap, for small numbers tell as much as large ones.
fn known(name: &str) -> bool {
    let small = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let power = name.strip_prefix(small).and_then(|digits| digits.parse::<u32>().ok());
    let knots = ["knot0", "knot2", "knots0", "knots2", "knotc"];
    knots.contains(&name)
        || (power.is_some_and(|power| (1..=8).contains(&power))
            && ["rnd", "pack", "mirrors", "cyl", "cone", "box"].contains(&small))
}

#[cfg(test)]
mod tests {
    use super::Part;
    use super::Plan;
    use super::known;

    fn plan(quick: bool, only: &[&str]) -> Result<Plan, String> {
        Plan::new(quick, &only.iter().map(|&name| name.to_owned()).collect::<Vec<_>>(), None)
    }

    #[test]
    fn names_choose_parts_and_scenes() {
        let all = plan(false, &[]).expect("a whole run");
        assert!(all.whole && all.parts.len() == 5 && all.rounds == 3);
        let rays = plan(false, &["rays"]).expect("a part");
        assert!(rays.whole && rays.parts.len() == 1 && rays.parts[0].0 == Part::Rays);
        let scene = plan(false, &["cyl6"]).expect("a scene of one part");
        assert_eq!(scene.parts, [(Part::Rays, vec!["cyl6".to_owned()])]);
        let both = plan(false, &["images", "rnd3"]).expect("a scene for a part that does not plan it");
        assert_eq!(both.parts, [(Part::Images, vec!["rnd3".to_owned()])]);
        assert!(!both.whole && !plan(true, &[]).expect("a quick run").whole);
        assert!(plan(false, &["rnd33"]).is_err());
        assert_eq!(plan(true, &[]).expect("a quick run").parts.len(), 4);
        let python = plan(true, &["python"]).expect("a quick part");
        assert_eq!(python.parts, [(Part::Python, vec!["rnd5".to_owned()])]);
    }

    #[test]
    fn every_planned_scene_is_known() {
        for part in Part::ALL {
            for name in part.scenes().iter().chain(part.quick_scenes()) {
                assert!(known(name) || crate::files::is_shared(name), "{name}");
            }
        }
    }
}
