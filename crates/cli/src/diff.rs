//! The first lines in which two texts differ.

/// So far ahead a line is looked for on the other side.
const AHEAD: usize = 60;
/// So many places of difference are shown, and of each so many lines.
const PLACES: usize = 3;
const LINES: usize = 8;

/// Lines that go begin with `-`, lines that come with `+`, below the number of the old line; long ones are cut.
pub fn short_diff(old: &str, new: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.split('\n').collect(), new.split('\n').collect());
    let mut text = String::new();
    let (mut a, mut b, mut places) = (0, 0, 0);
    while a < old.len() || b < new.len() {
        if old.get(a).is_some() && old.get(a) == new.get(b) {
            (a, b) = (a + 1, b + 1);
            continue;
        }
        if places == PLACES {
            text.push_str("  … and more below\n");
            break;
        }
        places += 1;
        let (gone, come) = meeting(old.get(a..).unwrap_or_default(), new.get(b..).unwrap_or_default());
        text.push_str(&format!("  line {}:\n", a + 1));
        push(&mut text, '-', old.get(a..a + gone).unwrap_or_default());
        push(&mut text, '+', new.get(b..b + come).unwrap_or_default());
        (a, b) = (a + gone, b + come);
    }
    text
}

/// How many lines of each side come before both go on alike.
fn meeting(old: &[&str], new: &[&str]) -> (usize, usize) {
    for distance in 1..=2 * AHEAD {
        for gone in 0..=distance.min(AHEAD) {
            let come = distance - gone;
            let (a, b) = (old.get(gone), new.get(come));
            // Empty lines are alike everywhere.
            if come <= AHEAD && a.is_some_and(|line| !line.trim().is_empty()) && a == b {
                return (gone, come);
            }
        }
    }
    (old.len(), new.len())
}

fn push(text: &mut String, sign: char, lines: &[&str]) {
    const COLUMNS: usize = 100;
    for line in lines.iter().take(LINES) {
        let line = line.replace('\r', "␍").replace('\t', "→");
        let cut: String = line.chars().take(COLUMNS).collect();
        let more = if cut.len() < line.len() { "…" } else { "" };
        text.push_str(&format!("  {sign} {cut}{more}\n"));
    }
    if lines.len() > LINES {
        text.push_str(&format!("  {sign} … {} more lines\n", lines.len() - LINES));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_differs_is_shown() {
        assert_eq!(short_diff("a\nb\n", "a\nb\n"), "");
        assert_eq!(short_diff("a\n b\nc\n", "a\nb\nc\n"), "  line 2:\n  -  b\n  + b\n");
        assert_eq!(short_diff("a\nc", "a\nb\nc\n"), "  line 2:\n  + b\n  line 3:\n  + \n");
    }

    #[test]
    fn much_is_cut() {
        let old: String = (0..1000).map(|n| format!("{n}\n same\n")).collect();
        let text = short_diff(&old, &old.replace(" same", "same"));
        assert!(text.ends_with("… and more below\n") && text.lines().count() < 20, "{text}");
        let text = short_diff(&"x\n".repeat(500), &"y".repeat(500));
        assert!(text.contains("more lines") && text.lines().all(|line| line.chars().count() < 110), "{text}");
    }
}
