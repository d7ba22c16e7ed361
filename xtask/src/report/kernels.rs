//! The tables of rays, builds, reading and pictures from memory.

use crate::figures::short;
use crate::rays::SETS;
use crate::report::NOTHING;
use crate::report::Table;
use crate::results::BuildRow;
use crate::results::KernelRow;
use crate::results::MemoryRow;
use crate::results::ParseRow;
use crate::results::RayRow;

fn ratio(ours: f64, theirs: Option<f64>) -> String {
    theirs.map_or(NOTHING.to_owned(), |theirs| format!("{}×", short(ours / theirs)))
}

/// How far two programs' hits on the same rays are apart: by number and by mean t. An edge or a grazing ray may fall
/// either way in single precision; a few in ten thousand are the same work.
fn apart(ours: &RayRow, theirs: &RayRow) -> String {
    let relative = |a: f64, b: f64| (a - b).abs() / b.abs().max(f64::MIN_POSITIVE);
    // Packets leave out a rest of fewer than 16 rays.
    let share = |row: &RayRow| row.hits as f64 / row.rays.max(1) as f64;
    let hits = relative(share(ours), share(theirs));
    let depth = if ours.set == "shadow" { 0.0 } else { relative(ours.mean_t, theirs.mean_t) };
    format!("{:.3} %", 100.0 * hits.max(depth))
}

/// Rates of rays, then of builds.
pub fn rays(rows: &[KernelRow]) -> String {
    let mut rates = Table::new(&[
        "scene",
        "rays",
        "dotray, Mrays/s",
        "Embree single",
        "Embree packets",
        "÷ single",
        "÷ packets",
        "hits apart",
    ]);
    let mut builds = Table::new(&[
        "scene",
        "shapes",
        "dotray, M shapes/s",
        "Embree",
        "÷ Embree",
        "dotray, B a shape",
        "Embree",
    ]);
    let (mut of_rays, mut of_builds) = (Vec::new(), Vec::new());
    for row in rows {
        match row {
            KernelRow::Rays(row) => of_rays.push(row),
            KernelRow::Build(row) => of_builds.push(row),
        }
    }
    for ours in of_rays.iter().filter(|row| row.mode == "batch") {
        let theirs = |mode: &str| {
            of_rays.iter().find(|row| row.scene == ours.scene && row.set == ours.set && row.mode == mode)
        };
        let (single, packet) = (theirs("single"), theirs("packet"));
        let rate = |row: Option<&&RayRow>| row.map_or(NOTHING.to_owned(), |row| short(row.rate));
        rates.row(vec![
            ours.scene.clone(),
            ours.set.clone(),
            short(ours.rate),
            rate(single),
            rate(packet),
            ratio(ours.rate, single.map(|row| row.rate)),
            ratio(ours.rate, packet.map(|row| row.rate)),
            single.map_or(NOTHING.to_owned(), |single| apart(ours, single)),
        ]);
    }
    let rate = |row: &BuildRow| row.shapes as f64 * 1e-6 / row.cpu;
    let bytes = |row: &BuildRow| format!("{:.0}", row.bytes as f64 / row.shapes.max(1) as f64);
    for ours in of_builds.iter().filter(|row| row.program.starts_with("dotray")) {
        let theirs = of_builds.iter().find(|row| row.scene == ours.scene && row.program != ours.program);
        builds.row(vec![
            ours.scene.clone(),
            ours.shapes.to_string(),
            short(rate(ours)),
            theirs.map_or(NOTHING.to_owned(), |row| short(rate(row))),
            ratio(rate(ours), theirs.map(|row| rate(row))),
            bytes(ours),
            theirs.map_or(NOTHING.to_owned(), |row| bytes(row)),
        ]);
    }
    debug_assert!(of_rays.iter().all(|row| SETS.contains(&row.set.as_str())));
    let mut programs: Vec<_> = of_builds.iter().map(|row| row.program.as_str()).collect();
    programs.sort_unstable();
    programs.dedup();
    format!("Programs: {}.\n\n{}\n{}", programs.join(", "), rates.markdown(), builds.markdown())
}

/// Rates of reading.
pub fn parse(rows: &[ParseRow]) -> String {
    let mut table =
        Table::new(&["scene", "MB", "dotray, MB/s a thread", "on all threads", "floor", "of the floor"]);
    for ours in rows.iter().filter(|row| row.program == "dotray") {
        let floor = rows.iter().find(|row| row.scene == ours.scene && row.program == "floor");
        table.row(vec![
            ours.scene.clone(),
            format!("{:.0}", ours.bytes as f64 * 1e-6),
            format!("{:.0}", ours.rate()),
            format!("{:.0}", ours.bytes as f64 * 1e-6 / ours.wall),
            floor.map_or(NOTHING.to_owned(), |floor| format!("{:.0}", floor.rate())),
            floor.map_or(NOTHING.to_owned(), |floor| format!("{:.0} %", 100.0 * ours.rate() / floor.rate())),
        ]);
    }
    table.markdown()
}

/// Pictures from memory.
pub fn memory(rows: &[MemoryRow]) -> String {
    let mut table = Table::new(&["scene", "program", "CPU s", "÷ dotray"]);
    for row in rows {
        let ours = rows.iter().find(|other| other.scene == row.scene && other.program == "dotray");
        let cells = match (&row.missing, ours) {
            (Some(why), _) => [format!("not available: {why}"), NOTHING.to_owned()],
            (None, Some(ours)) => [short(row.cpu), ratio(row.cpu, Some(ours.cpu))],
            (None, None) => [short(row.cpu), NOTHING.to_owned()],
        };
        table.row([vec![row.scene.clone(), row.program.clone()], cells.to_vec()].concat());
    }
    table.markdown()
}

#[cfg(test)]
mod tests {
    use super::rays;
    use crate::results::BuildRow;
    use crate::results::KernelRow;
    use crate::results::RayRow;

    #[test]
    fn rates_stand_beside_their_peers() {
        let row = |mode: &str, rate: f64, hits: u64| {
            let word = |text: &str| text.to_owned();
            let (scene, set, program) = (word("rnd3"), word("shadow"), word("x"));
            KernelRow::Rays(RayRow {
                scene,
                set,
                program,
                mode: word(mode),
                rays: 100,
                rate,
                hits,
                mean_t: 0.0,
            })
        };
        let build = |program: &str, cpu: f64, bytes: u64| {
            let (scene, program) = ("rnd3".to_owned(), program.to_owned());
            KernelRow::Build(BuildRow { scene, program, shapes: 1_000_000, cpu, bytes })
        };
        let rows = [
            row("batch", 3.0, 50),
            row("single", 2.0, 50),
            row("packet", 4.0, 50),
            build("dotray (avx2)", 0.5, 44_000_000),
            build("Embree 4.4.0", 1.0, 50_000_000),
        ];
        let text = rays(&rows);
        let programs = "Embree 4.4.0, dotray (avx2)";
        for cell in ["1.50×", "0.750×", "0.000 %", "2.00×", "| 44 ", "| 50 ", programs] {
            assert!(text.contains(cell), "{cell} in {text}");
        }
    }
}
