//! `dotray merge`: the pieces of a plan put together.

use std::io;
use std::path::PathBuf;

use crate::exit::Failure;
use crate::exit::say;
use crate::extras::Encoded;
use crate::extras::encoded;
use crate::interrupt;
use crate::many_args::MergeArgs;
use crate::meaning::Place;
use crate::numbered::numbered;
use crate::numbered::ranges;
use crate::output;
use crate::pieces::Part;
use crate::pieces::PiecePlan;
use crate::pieces::Sheet;
use crate::plan::Plan;
use crate::plan::plan;
use crate::render_args::RenderArgs;

/// Reads every piece and writes every picture that is whole.
pub fn run(typed: &MergeArgs) -> Result<(), Failure> {
    let pieces = PiecePlan::read(&typed.plan)?;
    let render = RenderArgs {
        output_option: Some(typed.output.clone()),
        format: typed.format,
        depth: typed.depth,
        jpeg_quality: typed.jpeg_quality,
        srgb: typed.srgb,
        quiet: typed.quiet,
        ..pieces.render_args(&[])?
    };
    let plan = plan(&render)?;
    if !typed.folder.is_dir() {
        return Err(Failure::Failed(format!("`{}` is no folder of pieces", typed.folder.display())));
    }
    interrupt::watch();
    let mut merge = Merge { pieces: &pieces, plan: &plan, typed, missing: Vec::new(), written: 0 };
    let frames = merge.frames();
    let all = frames.len();
    for frame in frames {
        interrupt::check()?;
        merge.frame(frame)?;
    }
    let Merge { mut missing, written, .. } = merge;
    missing.sort_unstable();
    missing.dedup();
    if !missing.is_empty() {
        let (count, of) = (missing.len(), pieces.pieces.len());
        let of_frames =
            if all > 1 { format!("; {written} of {all} frames were written") } else { String::new() };
        return Err(Failure::Failed(format!(
            "{count} of {of} pieces are missing or not whole: {}{of_frames}\nmake each of them by: \
             dotray work {} --piece N -o {}",
            ranges(&missing),
            typed.plan.display(),
            typed.folder.display()
        )));
    }
    if !typed.quiet {
        let what = if all > 1 { format!("{all} frames") } else { typed.output.display().to_string() };
        say(&format!("wrote {what} of {} pieces", pieces.pieces.len()));
    }
    Ok(())
}

struct Merge<'a> {
    pieces: &'a PiecePlan,
    plan: &'a Plan,
    typed: &'a MergeArgs,
    /// The numbers of pieces that lack something.
    missing: Vec<u32>,
    /// Pictures that were whole.
    written: usize,
}

impl Merge<'_> {
    /// The frames in order, each once.
    fn frames(&self) -> Vec<Option<u32>> {
        let parts = self.pieces.pieces.iter().flat_map(|piece| &piece.parts);
        let mut frames: Vec<Option<u32>> = parts.map(|part| part.frame).collect();
        frames.sort_unstable();
        frames.dedup();
        frames
    }

    fn frame(&mut self, frame: Option<u32>) -> Result<(), Failure> {
        let mut sheet = Sheet::new(self.plan, &self.plan.layers)?;
        for (number, piece) in (0..).zip(&self.pieces.pieces) {
            for part in piece.parts.iter().filter(|part| part.frame == frame) {
                if !self.read(number, part, &mut sheet) {
                    self.missing.push(number);
                }
            }
        }
        if !sheet.is_complete() {
            return Ok(());
        }
        let output = match (frame, &self.plan.output) {
            (Some(frame), Place::File(path)) => Place::File(numbered(path, frame)?),
            (Some(_), Place::Standard) => {
                return Err(Failure::Usage("frames need names, such as -o out.####.png".to_owned()));
            }
            (None, place) => place.clone(),
        };
        let plan = Plan { output, ..self.plan.clone() };
        let Encoded { picture, layers } =
            encoded(sheet.picture.image(), sheet.layers.into_pictures(), &plan)?;
        output::write_all(&plan.output, &picture, &layers)?;
        self.written += 1;
        Ok(())
    }

    /// Puts a part's tiles on the sheet; false, and told where it is not simply absent, if it is not whole.
    fn read(&self, number: u32, part: &Part, sheet: &mut Sheet) -> bool {
        let path: PathBuf = self.pieces.path(&self.typed.folder, number, part);
        let mut tiles = Vec::new();
        let contents = match sheet.read(&path, part, |pixels| tiles.push(pixels)) {
            Ok(contents) => contents,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return false,
            Err(error) => {
                say(&format!("warning: cannot read `{}`: {error}", path.display()));
                return false;
            }
        };
        let expected = self.pieces.fingerprint(part.frame);
        let there = contents.fingerprint.unwrap_or_default();
        let differences = there.differences(&expected, "in the piece", "in the plan");
        if !differences.is_empty() {
            let list = differences.join("; ");
            say(&format!("warning: `{}` belongs to another picture ({list})", path.display()));
            return false;
        }
        let stored = tiles.iter().filter(|pixels| sheet.store(pixels)).count();
        if stored as u32 != part.count {
            say(&format!(
                "warning: `{}` is damaged: {stored} of {} tiles are whole",
                path.display(),
                part.count
            ));
        }
        stored as u32 == part.count
    }
}
