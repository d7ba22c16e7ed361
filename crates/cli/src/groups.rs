//! The groups of a scene's main file, by name or by a path of numbers.

use dotray::scene::Scene;
use dotray::scene::Sources;
use dotray::scene::model::Item;
use dotray::scene::model::SceneFile;

/// A group that can be asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupName {
    /// Its number in the file's list of groups.
    pub number: u32,
    /// Its place: numbers from 0 among the groups that stand in the same one, such as 0/2.
    pub path: String,
    /// The text of a comment `// name` behind `#group_begin` on its line.
    pub name: Option<String>,
}

/// The groups of the main file in order.
pub fn groups_of(scene: &Scene, sources: &Sources) -> Vec<GroupName> {
    let Some(main) = scene.files.first() else { return Vec::new() };
    let mut found = Vec::new();
    // The paths of the open groups, each with how many groups have begun in it.
    let mut open: Vec<(String, u32)> = vec![(String::new(), 0)];
    for item in &main.items {
        match item {
            Item::Open(number) => {
                let Some((around, count)) = open.last_mut() else { continue };
                let path = if around.is_empty() { count.to_string() } else { format!("{around}/{count}") };
                *count += 1;
                found.push(GroupName {
                    number: *number,
                    path: path.clone(),
                    name: name(main, *number, sources),
                });
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

/// The number of the group that a path or a name stands for.
pub fn find(groups: &[GroupName], wanted: &str) -> Result<u32, String> {
    let is_wanted = |group: &&GroupName| group.path == wanted || group.name.as_deref() == Some(wanted);
    let found: Vec<&GroupName> = groups.iter().filter(is_wanted).collect();
    match found[..] {
        [one] => Ok(one.number),
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
            let known = if known.is_empty() { "it has none".to_owned() } else { known.join(", ") };
            Err(format!("the scene's file has no group `{wanted}`: {known}"))
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
        assert_eq!((find(&groups, "hand"), find(&groups, "0/0"), find(&groups, "1")), (Ok(2), Ok(1), Ok(3)));
        assert!(find(&groups, "arm").unwrap_err().ends_with("say 0 or 1"));
        assert!(find(&groups, "leg").unwrap_err().contains("0 (arm), 0/0, 0/1 (hand), 1 (arm)"));
    }
}
