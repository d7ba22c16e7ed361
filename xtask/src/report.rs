//! Results as Markdown tables, on the terminal and between the markers of docs/bench.md.

mod images;
mod kernels;
mod python;

use crate::machine::Machine;
use crate::results::Results;
use std::path::Path;

/// A table of plain words.
struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Starts with the heads of the columns.
    fn new(heads: &[&str]) -> Self {
        Self { rows: vec![heads.iter().map(|head| (*head).to_owned()).collect()] }
    }

    fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// Markdown, columns aligned for those who read it as text.
    fn markdown(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
        };
        let widths: Vec<_> = (0..columns).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells = widths.iter().enumerate().map(|(column, width)| {
                let cell = row.get(column).map_or("", String::as_str);
                format!(" {cell:width$} |")
            });
            format!("|{}\n", cells.collect::<String>())
        };
        let rule: String = widths.iter().map(|width| format!(" {} |", "-".repeat(*width))).collect();
        let (head, body) = self.rows.split_at(1.min(self.rows.len()));
        head.iter().map(line).collect::<String>()
            + &format!("|{rule}\n")
            + &body.iter().map(line).collect::<String>()
    }
}

/// Places of a table that no figure stands for.
const NOTHING: &str = "–";

fn machine(machine: &Machine, rounds: usize) -> String {
    let peers: Vec<_> = machine.peers.iter().map(|(name, version)| format!("{name}: {version}")).collect();
    format!("{} Medians of {rounds} rounds. {}.\n", machine.sentence(), peers.join("; "))
}

/// The tables of each part that there are results of, by the part's word.
pub fn tables(results: &Results) -> Vec<(&'static str, String)> {
    let mut tables = Vec::new();
    if let Some(part) = &results.images {
        tables.push(("images", machine(&part.machine, part.rounds) + "\n" + &images::table(&part.rows)));
    }
    if let Some(part) = &results.rays {
        tables.push(("rays", machine(&part.machine, part.rounds) + "\n" + &kernels::rays(&part.rows)));
    }
    if let Some(part) = &results.parse {
        tables.push(("parse", machine(&part.machine, part.rounds) + "\n" + &kernels::parse(&part.rows)));
    }
    if let Some(part) = &results.memory {
        tables.push(("memory", machine(&part.machine, part.rounds) + "\n" + &kernels::memory(&part.rows)));
    }
    if let Some(part) = &results.python {
        tables.push(("python", machine(&part.machine, part.rounds) + "\n" + &python::table(&part.rows)));
    }
    tables
}

/// The page with what stands between a part's markers replaced.
fn replaced(page: &str, name: &str, table: &str) -> Option<String> {
    let (begin, end) = (format!("<!-- {name}: begin -->"), format!("<!-- {name}: end -->"));
    let (before, rest) = page.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some(format!("{before}{begin}\n\n{table}\n{end}{after}"))
}

/// Puts tables between their markers in the page.
///
/// # Errors
/// Where the page or a marker is missing.
pub fn write_page(page: &Path, tables: &[(&'static str, String)]) -> Result<(), String> {
    let told = |fault: std::io::Error| format!("{}: {fault}", page.display());
    let mut text = std::fs::read_to_string(page).map_err(told)?;
    for (name, table) in tables {
        let missing = || format!("{}: no markers for `{name}`", page.display());
        text = replaced(&text, name, table).ok_or_else(missing)?;
    }
    std::fs::write(page, text).map_err(told)
}

#[cfg(test)]
mod tests {
    use super::Table;
    use super::replaced;
    use crate::plan::Part;
    use std::path::Path;

    #[test]
    fn the_page_has_a_place_for_every_part() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/bench.md");
        let text = std::fs::read_to_string(page).expect("the page stands beside the crates");
        for part in Part::ALL {
            assert!(
                replaced(&text, part.name(), "table").is_some_and(|new| new.contains("table")),
                "{part:?}"
            );
        }
    }

    #[test]
    fn tables_are_aligned() {
        let mut table = Table::new(&["scene", "s"]);
        table.row(vec!["a".to_owned(), "1.25".to_owned()]);
        assert_eq!(table.markdown(), "| scene | s    |\n| ----- | ---- |\n| a     | 1.25 |\n");
    }

    #[test]
    fn only_what_stands_between_the_markers_changes() {
        let page = "a\n<!-- rays: begin -->\nold\n<!-- rays: end -->\nb";
        let new = "a\n<!-- rays: begin -->\n\nnew\n\n<!-- rays: end -->\nb";
        assert_eq!(replaced(page, "rays", "new\n").as_deref(), Some(new));
        assert_eq!(replaced(page, "images", "new"), None);
    }
}
