//! What threads, processes and their children have computed. Systems without such clocks give nothing.

use serde::Deserialize;
use serde::Serialize;

/// What a child process has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Usage {
    /// Seconds in its own code, all threads together.
    pub user: f64,
    /// Seconds in the system's code.
    pub system: f64,
    /// Seconds on the wall.
    pub wall: f64,
    /// The most memory it held at once.
    pub peak_mib: f64,
    /// Whether it ended well and in time.
    pub fine: bool,
}

impl Usage {
    /// User and system time.
    pub fn cpu(&self) -> f64 {
        self.user + self.system
    }
}

/// Whether this system has the clocks that the bench needs.
pub const AVAILABLE: bool = cfg!(unix);

#[cfg(unix)]
mod system {
    use nix::sys::resource::UsageWho;
    use nix::sys::resource::getrusage;
    use nix::sys::time::TimeValLike;
    use nix::time::ClockId;
    use nix::time::clock_gettime;

    fn seconds(clock: ClockId) -> f64 {
        clock_gettime(clock).map_or(0.0, |time| time.num_nanoseconds() as f64 * 1e-9)
    }

    /// Seconds that this thread has computed.
    pub fn thread_cpu() -> f64 {
        seconds(ClockId::CLOCK_THREAD_CPUTIME_ID)
    }

    /// Seconds that all threads of this process have computed.
    pub fn process_cpu() -> f64 {
        seconds(ClockId::CLOCK_PROCESS_CPUTIME_ID)
    }

    /// User seconds, system seconds and the peak in MiB of the children that have ended.
    pub fn of_children() -> (f64, f64, f64) {
        // The peak is told in kibibytes, on Apple's systems in bytes.
        let unit = if cfg!(target_vendor = "apple") { 1.0 / (1024.0 * 1024.0) } else { 1.0 / 1024.0 };
        getrusage(UsageWho::RUSAGE_CHILDREN).map_or((0.0, 0.0, 0.0), |usage| {
            let micro = |time: nix::sys::time::TimeVal| time.num_microseconds() as f64 * 1e-6;
            (micro(usage.user_time()), micro(usage.system_time()), usage.max_rss() as f64 * unit)
        })
    }
}

#[cfg(not(unix))]
mod system {
    /// Nothing to tell.
    pub fn thread_cpu() -> f64 {
        0.0
    }

    /// Nothing to tell.
    pub fn process_cpu() -> f64 {
        0.0
    }

    /// Nothing to tell.
    pub fn of_children() -> (f64, f64, f64) {
        (0.0, 0.0, 0.0)
    }
}

pub use system::of_children;
pub use system::process_cpu;
pub use system::thread_cpu;

#[cfg(all(test, unix))]
mod tests {
    use super::process_cpu;
    use super::thread_cpu;

    #[test]
    fn clocks_run_while_something_is_computed() {
        let (thread, process) = (thread_cpu(), process_cpu());
        let mut sum = 0_u64;
        while thread_cpu() < thread + 0.01 {
            sum = (0..1000_u64).fold(sum, |sum, i| std::hint::black_box(sum.wrapping_add(i)));
        }
        assert!(process_cpu() > process + 0.005, "{sum}");
    }
}
