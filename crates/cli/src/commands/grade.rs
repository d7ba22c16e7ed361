//! `dotray grade`: somebody else's program over a suite of scenes.

use dotray_grade::error::GradeError;
use dotray_grade::grade::Observer;
use dotray_grade::grade::Outcome;
use dotray_grade::grade::grade;
use dotray_grade::report::Report;
use dotray_grade::report::html;
use dotray_grade::report::json;
use dotray_grade::report::junit;
use dotray_grade::report::text;
use dotray_grade::suite::Suite;
use dotray_grade::suite::Test;
use dotray_grade::template::Template;
use std::fmt::Write;
use std::io::IsTerminal;
use std::num::NonZero;
use std::path::PathBuf;
use std::time::Instant;

use crate::exit::Failure;
use crate::exit::put;
use crate::exit::say;
use crate::interrupt;
use crate::judge_args::GradeArgs;
use crate::meaning::Place;
use crate::output;

/// Tells who waits at a terminal what is finished, and listens to Ctrl-C.
struct Watcher {
    tell: bool,
}

impl Observer for Watcher {
    fn finished(&self, test: &Test, outcome: &Outcome) {
        if self.tell {
            say(&text::line(test, outcome));
        }
    }

    fn stop(&self) -> bool {
        interrupt::pressed()
    }
}

/// Runs the program and writes the reports; [`Failure::Over`] where it lost points.
pub fn run(typed: &GradeArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let mut suite = Suite::read(&typed.suite).map_err(|error| failure(&error))?;
    suite.keep_if_any(&typed.only).map_err(Failure::Usage)?;
    let Some(program) = &typed.program else { return put(listed(&suite).as_bytes()) };
    let here = std::env::current_dir()
        .map_err(|error| Failure::Failed(format!("cannot tell the working directory: {error}")))?;
    let template = Template::parse(program).map_err(|error| failure(&error))?.rooted(&here);
    let files = [&typed.html, &typed.json, &typed.junit, &typed.gradescope];
    for path in files.into_iter().flatten() {
        output::check(&Place::File(path.clone()), &Place::File(typed.suite.clone()))?;
    }
    interrupt::watch();
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    let jobs = typed.jobs.map_or(cores, usize::from);
    let watcher = Watcher { tell: !typed.quiet && std::io::stderr().is_terminal() };
    let outcomes = grade(&suite, &template, jobs, &watcher).map_err(|error| failure(&error))?;
    interrupt::check()?;

    let seconds = start.elapsed().as_secs_f64();
    let report = Report { suite: &suite, outcomes: &outcomes, program, seconds };
    let write = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
        Some(path) => output::write(&Place::File(path.clone()), text().as_bytes()),
        None => Ok(()),
    };
    write(&typed.html, &|| html::page(&report))?;
    write(&typed.json, &|| format!("{:#}\n", json::own(&report)))?;
    write(&typed.junit, &|| junit::xml(&report))?;
    write(&typed.gradescope, &|| format!("{:#}\n", json::gradescope(&report)))?;
    if !typed.quiet {
        put(text::table(&report).as_bytes())?;
    }
    if report.is_perfect() { Ok(()) } else { Err(Failure::Over) }
}

fn failure(error: &GradeError) -> Failure {
    match error {
        GradeError::Program(_) => Failure::Usage(error.to_string()),
        GradeError::Read { .. }
        | GradeError::Suite { .. }
        | GradeError::Scene { .. }
        | GradeError::Machine(_) => Failure::Failed(error.to_string()),
    }
}

/// What a suite holds, for whoever has no program yet.
fn listed(suite: &Suite) -> String {
    let mut text = format!("{}\n\n", suite.title);
    for test in &suite.tests {
        let (width, height) = (test.options.width, test.options.height);
        // Writing to a string does not fail.
        let _ = writeln!(text, "{:<24}{:>6}  {width}x{height}  {}", test.name, test.points, test.title);
    }
    let _ = writeln!(text, "\n{} tests, {} points", suite.tests.len(), suite.points());
    text
}
