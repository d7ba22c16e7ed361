//! The groups of a scene's files, by name or by a path of numbers.

use dotray::scene::Scene;
use dotray::scene::Sources;
use dotray::scene::model::Item;
use dotray::scene::model::SceneFile;

/// A group that can be asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupName {
    /// The number of its file in the scene.
    pub file: usize,
    /// Its number in the file's list of groups.
    pub number: u32,
    /// Its place: numbers from 0 among the groups that stand in the same one, such as 0/2; in an included file behind
    /// the file's name, such as hand.ray:0/2.
    pub path: String,
    /// The text of a comment `// name` behind `#group_begin` on its line.
    pub name: Option<String>,
    /// The name behind that of the included file.
    full_name: Option<String>,
}

/// The groups of all files in order.
pub fn groups_of(scene: &Scene, sources: &Sources) -> Vec<GroupName> {
    let files = scene.files.iter().enumerate();
    files.flat_map(|(number, file)| groups_in(scene, number, file, sources)).collect()
}

/// What stands before the places and names of groups in a file: nothing in the main one.
fn prefix(scene: &Scene, number: usize) -> String {
    let mut includes = scene.files.iter().flat_map(|file| &file.includes);
    let include = includes.find(|include| include.value.file.0 as usize == number).filter(|_| number > 0);
    include.map_or_else(String::new, |include| format!("{}:", include.value.name))
}

fn groups_in(scene: &Scene, number: usize, file: &SceneFile, sources: &Sources) -> Vec<GroupName> {
    let prefix = prefix(scene, number);
    let mut found = Vec::new();
    // The paths of the open groups, each with how many groups have begun in it.
    let mut open: Vec<(String, u32)> = vec![(prefix.clone(), 0)];
    for item in &file.items {
        match item {
            Item::Open(group) => {
                let inner = open.len() > 1;
                let Some((around, count)) = open.last_mut() else { continue };
                let path = if inner { format!("{around}/{count}") } else { format!("{around}{count}") };
                *count += 1;
                let name = name(file, *group, sources);
                let full_name = name.as_ref().map(|name| format!("{prefix}{name}"));
                found.push(GroupName { file: number, number: *group, path: path.clone(), name, full_name });
                open.push((path, 0));
            }
            Item::Close => {
                open.pop();
            }
            Item::Run { .. } | Item::Instance(_) => {}
        }
    }
    found
}

fn name(file: &SceneFile, number: u32, sources: &Sources) -> Option<String> {
    let span = file.groups.get(number as usize)?.span;
    let text = sources.bytes(span.file).get(usize::try_from(span.start).ok()?..)?;
    let line = text.split(|byte| *byte == b'\n' || *byte == b'\r').next()?;
    let line = String::from_utf8_lossy(line);
    let (_, comment) = line.split_once("//")?;
    let name = comment.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

/// The numbers of the file and of the group that a path or a name stands for.
pub fn find(groups: &[GroupName], wanted: &str) -> Result<(usize, u32), String> {
    let names =
        |group: &GroupName| [group.name.as_deref(), group.full_name.as_deref()].contains(&Some(wanted));
    let is_wanted = |group: &&GroupName| group.path == wanted || names(group);
    let found: Vec<&GroupName> = groups.iter().filter(is_wanted).collect();
    match found[..] {
        [one] => Ok((one.file, one.number)),
        [] => {
            const SHOWN: usize = 12;
            let mut known: Vec<String> = groups
                .iter()
                .take(SHOWN)
                .map(|group| match &group.name {
                    Some(name) => format!("{} ({name})", group.path),
                    None => group.path.clone(),
                })
                .collect();
            if groups.len() > SHOWN {
                known.push(format!("and {} more", groups.len() - SHOWN));
            }
            let known = if known.is_empty() { "they have none".to_owned() } else { known.join(", ") };
            Err(format!("the scene's files have no group `{wanted}`: {known}"))
        }
        _ => {
            let paths: Vec<&str> = found.iter().map(|group| group.path.as_str()).collect();
            Err(format!("more than one group is named `{wanted}`: say {}", paths.join(" or ")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray::scene::files::Disk;
    use dotray::scene::load::LoadOptions;
    use dotray::scene::load::load_text;

    #[test]
    fn groups_have_paths_and_names() {
        let one = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n";
        let text = format!(
            "#group_begin // arm\n{one}#group_begin {one}#group_end\n#group_begin // hand \n{one}#group_end\n\
             #group_end\n\
             #group_begin // arm\n{one}#group_end\n"
        );
        let loaded = load_text("a.ray", text, &Disk, &LoadOptions::default());
        let groups = groups_of(&loaded.scene.expect("a scene"), &loaded.sources);
        let paths: Vec<&str> = groups.iter().map(|group| group.path.as_str()).collect();
        assert_eq!(paths, ["0", "0/0", "0/1", "1"]);
        let numbers = ["hand", "0/0", "1"].map(|wanted| find(&groups, wanted));
        assert_eq!(numbers, [Ok((0, 2)), Ok((0, 1)), Ok((0, 3))]);
        assert!(find(&groups, "arm").unwrap_err().ends_with("say 0 or 1"));
        assert!(find(&groups, "leg").unwrap_err().contains("0 (arm), 0/0, 0/1 (hand), 1 (arm)"));
    }
}
