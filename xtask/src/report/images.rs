//! The table of whole programs.

use crate::figures::geometric_mean;
use crate::figures::short;
use crate::files::DATABASES;
use crate::report::NOTHING;
use crate::report::Table;
use crate::results::ImageRow;

/// One scene's figures.
struct Line<'a> {
    scene: &'a str,
    one: Option<&'a ImageRow>,
    two: Option<&'a ImageRow>,
    tachyon: Option<&'a ImageRow>,
    /// The faster of both ways of bounding.
    povray: Option<&'a ImageRow>,
}

impl<'a> Line<'a> {
    fn of(rows: &'a [ImageRow], scene: &'a str) -> Self {
        let good = |row: &&ImageRow| row.scene == scene && row.missing.is_none() && row.runs > 0;
        let find = |name: &str| rows.iter().find(|row| good(row) && row.program == name);
        let povray = rows.iter().filter(good).filter(|row| row.program.starts_with("POV-Ray"));
        Self {
            scene,
            one: find("dotray"),
            two: find("dotray, 2 threads"),
            tachyon: find("Tachyon"),
            povray: povray.min_by(|a, b| a.cpu.total_cmp(&b.cpu)),
        }
    }

    /// How many times as long the better peer takes.
    fn ratio(&self) -> Option<f64> {
        let peers = [self.tachyon, self.povray].into_iter().flatten().map(|row| row.cpu);
        let better = peers.min_by(f64::total_cmp)?;
        Some(better / self.one?.cpu)
    }

    /// How many times as long one thread takes as two.
    fn speedup(&self) -> Option<f64> {
        Some(self.one?.wall / self.two?.wall)
    }

    fn cells(&self) -> Vec<String> {
        let cpu = |row: Option<&ImageRow>| row.map_or(NOTHING.to_owned(), |row| short(row.cpu));
        let times =
            |value: Option<f64>| value.map_or(NOTHING.to_owned(), |value| format!("{}×", short(value)));
        let peak =
            |row: Option<&ImageRow>| row.map_or(NOTHING.to_owned(), |row| format!("{:.0}", row.peak_mib));
        let apart = |row: Option<&ImageRow>| {
            row.and_then(|row| row.difference).map_or(NOTHING.to_owned(), |d| format!("{:.1} %", 100.0 * d))
        };
        vec![
            self.scene.to_owned(),
            cpu(self.one),
            cpu(self.tachyon),
            cpu(self.povray),
            times(self.ratio()),
            self.two.map_or(NOTHING.to_owned(), |row| short(row.wall)),
            times(self.speedup()),
            [self.one, self.tachyon, self.povray].map(peak).join(" / "),
            [self.tachyon, self.povray].map(apart).join(" / "),
        ]
    }
}

fn mean(name: &str, lines: &[&Line]) -> Option<String> {
    let ratios: Vec<_> = lines.iter().filter_map(|line| line.ratio()).collect();
    let least = ratios.iter().copied().min_by(f64::total_cmp)?;
    let mean = geometric_mean(&ratios)?;
    Some(format!(
        "Geometric mean of the better peer ÷ dotray over {} {name}: **{}×**, least {}×.\n",
        ratios.len(),
        short(mean),
        short(least)
    ))
}

/// The table and its means.
pub fn table(rows: &[ImageRow]) -> String {
    let mut scenes: Vec<&str> = Vec::new();
    for row in rows {
        if !scenes.contains(&row.scene.as_str()) {
            scenes.push(&row.scene);
        }
    }
    let lines: Vec<_> = scenes.iter().map(|scene| Line::of(rows, scene)).collect();
    let mut table = Table::new(&[
        "scene",
        "dotray, CPU s",
        "Tachyon",
        "POV-Ray",
        "better ÷ dotray",
        "2 threads, s",
        "1 ÷ 2 threads",
        "peak MiB d / T / P",
        "difference T / P",
    ]);
    lines.iter().for_each(|line| table.row(line.cells()));
    let (databases, others): (Vec<_>, Vec<_>) =
        lines.iter().partition(|line| DATABASES.contains(&line.scene));
    let means = [mean("databases", &databases), mean("other scenes", &others)];
    let mut text = table.markdown() + "\n" + &means.into_iter().flatten().collect::<String>();
    let mut missing: Vec<_> = rows.iter().filter_map(|row| Some((row, row.missing.as_ref()?))).collect();
    // Both ways of POV-Ray miss for the same reason.
    missing.retain(|(row, _)| row.program != "POV-Ray +BM2");
    for (row, why) in missing {
        text += &format!("\n- {} {}: not available: {why}", row.scene, row.program);
    }
    text.trim_end().to_owned() + "\n"
}

#[cfg(test)]
mod tests {
    use super::table;
    use crate::results::ImageRow;

    fn row(program: &str, cpu: f64, wall: f64) -> ImageRow {
        ImageRow {
            scene: "balls4".to_owned(),
            program: program.to_owned(),
            runs: 3,
            cpu,
            wall,
            ..ImageRow::default()
        }
    }

    #[test]
    fn ratios_are_against_the_better_peer() {
        let rows = [
            row("dotray", 1.0, 1.0),
            row("dotray, 2 threads", 1.1, 0.5),
            row("Tachyon", 9.0, 9.0),
            row("POV-Ray +BM1", 8.0, 8.0),
            row("POV-Ray +BM2", 4.0, 4.0),
        ];
        let text = table(&rows);
        assert!(text.contains("| 4.00×"), "{text}");
        assert!(text.contains("| 2.00×"), "{text}");
        assert!(text.contains("over 1 databases: **4.00×**"), "{text}");
        let missing = ImageRow { missing: Some("no such program".to_owned()), ..row("Tachyon", 0.0, 0.0) };
        let text = table(&[row("dotray", 1.0, 1.0), missing]);
        assert!(
            text.contains("balls4 Tachyon: not available: no such program") && !text.contains("Geometric")
        );
    }
}
