//! Ending every process of a run: the group that it was started in, and whatever has left the group.

use std::process::Child;
#[cfg(unix)]
use std::time::Duration;
#[cfg(unix)]
use std::time::Instant;

#[cfg(unix)]
const CLEAN_ROUNDS: u32 = 4;
#[cfg(unix)]
const LONGEST_HUNT: Duration = Duration::from_secs(5);

/// The name of the variable by which processes of a run are known.
pub const MARK: &str = "DOTRAY_GRADE_RUN";

/// Ends the child, its group, and where the system tells processes' environments, all others with the run's mark. A
/// process that has left the group and cleared its environment is not found; its limits still hold.
#[cfg(unix)]
pub fn end_all(child: &mut Child, mark: &str) {
    use nix::sys::signal::Signal;
    use nix::sys::signal::killpg;
    use nix::unistd::Pid;
    if let Ok(group) = i32::try_from(child.id()) {
        // Fails where nobody is left.
        let _ = killpg(Pid::from_raw(group), Signal::SIGKILL);
    }
    let _ = child.wait();
    // A process that is just becoming another shows no environment, and one that copies itself all the time may be
    // a step ahead: it is gone when nothing has been found several times in a row.
    let start = Instant::now();
    let mut clean = 0;
    while clean < CLEAN_ROUNDS && start.elapsed() < LONGEST_HUNT {
        clean = if end_marked(mark) { 0 } else { clean + 1 };
        if clean > 0 {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// Ends all processes that carry the mark; false if there was none.
#[cfg(unix)]
fn end_marked(mark: &str) -> bool {
    use nix::sys::signal::Signal;
    use nix::sys::signal::kill;
    use nix::unistd::Pid;
    let wanted = format!("{MARK}={mark}");
    let mut found = false;
    for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
        let number = entry.file_name().to_str().and_then(|name| name.parse().ok());
        let Some(number) = number.filter(|&number: &i32| number > 1) else { continue };
        // Other users' processes cannot be read, nor are they ours; those that have ended have none.
        let environment = std::fs::read(entry.path().join("environ")).unwrap_or_default();
        if environment.split(|byte| *byte == 0).any(|variable| variable == wanted.as_bytes()) {
            found |= kill(Pid::from_raw(number), Signal::SIGKILL).is_ok();
        }
    }
    found
}

/// Ends the child; other systems have no groups that could be ended.
#[cfg(not(unix))]
pub fn end_all(child: &mut Child, _mark: &str) {
    let _ = child.kill();
    let _ = child.wait();
}
