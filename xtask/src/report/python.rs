//! The table of pictures from arrays of numpy.

use crate::figures::short;
use crate::report::NOTHING;
use crate::report::Table;
use crate::results::ImageRow;

/// Seconds and memory of each program, and how many times as much as dotray they are.
pub fn table(rows: &[ImageRow]) -> String {
    let heads = ["scene", "program", "CPU s", "÷ dotray", "wall s", "peak MiB", "÷ dotray", "difference"];
    let mut table = Table::new(&heads);
    for row in rows {
        let ours = |other: &&ImageRow| {
            other.scene == row.scene && other.program == "dotray" && other.missing.is_none()
        };
        let ours = rows.iter().find(ours);
        let times = |value: fn(&ImageRow) -> f64| {
            ours.map_or(NOTHING.to_owned(), |ours| format!("{}×", short(value(row) / value(ours))))
        };
        let cells = match &row.missing {
            Some(why) => vec![format!("not available: {why}")],
            None => vec![
                short(row.cpu),
                times(|row| row.cpu),
                short(row.wall),
                format!("{:.0}", row.peak_mib),
                times(|row| row.peak_mib),
                row.difference.map_or(NOTHING.to_owned(), |d| format!("{:.1} %", 100.0 * d)),
            ],
        };
        table.row([vec![row.scene.clone(), row.program.clone()], cells].concat());
    }
    table.markdown()
}

#[cfg(test)]
mod tests {
    use super::table;
    use crate::results::ImageRow;

    #[test]
    fn peers_stand_beside_dotray() {
        let row = |program: &str, cpu: f64, peak_mib: f64, missing: Option<&str>| ImageRow {
            scene: "rnd7".to_owned(),
            program: program.to_owned(),
            runs: 3,
            cpu,
            wall: cpu,
            peak_mib,
            missing: missing.map(str::to_owned),
            ..ImageRow::default()
        };
        let rows = [row("dotray", 10.0, 1000.0, None), row("OVITO", 30.0, 5000.0, None)];
        let text = table(&rows);
        assert!(text.contains("3.00×") && text.contains("5.00×") && text.contains("1.00×"), "{text}");
        let text = table(&[row("dotray", 0.0, 0.0, Some("no Python")), row("OVITO", 30.0, 5000.0, None)]);
        assert!(text.contains("not available: no Python") && !text.contains('×'), "{text}");
    }
}
