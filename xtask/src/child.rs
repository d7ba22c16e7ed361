//! Programs run from here, with what they cost.
//!
//! The cost of one child is what the system tells of all children of a process. So each measured program is started
//! by a small process of its own, this very program as `xtask measure`, whose only child it is.

use crate::clock;
use crate::clock::Usage;
use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::process::Stdio;
use std::time::Duration;
use std::time::Instant;

/// Runs `program` as this process's only child, its output into `log`, and stops it after `limit` seconds.
///
/// # Errors
/// Tells why the program cannot be started.
pub fn run_only_child(program: &str, arguments: &[String], log: &Path, limit: f64) -> Result<Usage, String> {
    let told = |fault: std::io::Error| format!("{program}: {fault}");
    let output = File::create(log).map_err(told)?;
    let errors = output.try_clone().map_err(told)?;
    let start = Instant::now();
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(output).stderr(errors);
    let mut child = command.spawn().map_err(told)?;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(told)? {
            break Some(status);
        }
        if start.elapsed().as_secs_f64() > limit {
            child.kill().map_err(told)?;
            child.wait().map_err(told)?;
            break None;
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let wall = start.elapsed().as_secs_f64();
    let (user, system, peak_mib) = clock::of_children();
    Ok(Usage { user, system, wall, peak_mib, fine: status.is_some_and(|status| status.success()) })
}

/// Runs a command under `xtask measure` and gives its cost; its output goes to `log`.
///
/// # Errors
/// Tells what could not be started or understood.
pub fn measure(command: &[String], log: &Path, limit: f64) -> Result<Usage, String> {
    let this = std::env::current_exe().map_err(|fault| fault.to_string())?;
    let output = Command::new(&this)
        .args(["measure", "--limit", &limit.to_string(), "--log"])
        .arg(log)
        .arg("--")
        .args(command)
        .output()
        .map_err(|fault| format!("{}: {fault}", this.display()))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().to_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|fault| fault.to_string())
}

/// Runs a command and gives its standard output.
///
/// # Errors
/// The last line that it printed of an error, else the last one, where it failed; or why it did not start.
pub fn output(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.stdin(Stdio::null()).output().map_err(|fault| format!("{name}: {fault}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    Err(format!("{name}: {}", last_word(&errors)))
}

/// The last line that speaks of an error, else the last one.
fn last_word(errors: &str) -> &str {
    let last =
        |word: &str| errors.lines().rev().map(str::trim).find(|line| !line.is_empty() && line.contains(word));
    last("rror").or_else(|| last("")).unwrap_or("failed without a word")
}

/// Whether a program can be started at all.
pub fn exists(program: &str) -> bool {
    let name = if cfg!(windows) { format!("{program}.exe") } else { program.to_owned() };
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(&name).is_file())
}

#[cfg(all(test, unix))]
mod tests {
    use super::exists;
    use super::last_word;
    use super::output;
    use super::run_only_child;
    use std::process::Command;

    #[test]
    fn output_and_faults_come_back() {
        assert_eq!(output(Command::new("echo").arg("so")), Ok("so\n".to_owned()));
        assert!(output(&mut Command::new("false")).is_err());
        assert!(exists("sh") && !exists("no-such-program-here"));
    }

    #[test]
    fn the_word_of_an_error_is_found() {
        assert_eq!(last_word("RuntimeError: no file\n\nSee the manual.\n"), "RuntimeError: no file");
        assert_eq!(last_word("one\n two \n\n"), "two");
        assert_eq!(last_word("\n"), "failed without a word");
    }

    #[test]
    fn a_child_is_stopped_at_its_limit_and_its_output_kept() {
        let log = std::env::temp_dir().join(format!("xtask-child-{}", std::process::id()));
        let words = |line: &str| ["-c".to_owned(), line.to_owned()];
        let late = run_only_child("sh", &words("sleep 5"), &log, 0.05);
        assert!(late.is_ok_and(|usage| !usage.fine && usage.wall < 4.0));
        let good = run_only_child("sh", &words("echo word"), &log, 5.0);
        assert!(good.is_ok_and(|usage| usage.fine && usage.peak_mib > 0.1));
        assert_eq!(std::fs::read_to_string(&log).ok().as_deref(), Some("word\n"));
        assert!(std::fs::remove_file(&log).is_ok());
    }
}
