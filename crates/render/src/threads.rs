//! On how many threads work runs.

use crate::error::RenderError;

/// Runs `work` on so many threads; `None` for the common ones, one a core.
///
/// # Errors
/// [`RenderError::Threads`] where they cannot be started.
pub fn on_threads<T: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> T + Send,
) -> Result<T, RenderError> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| RenderError::Threads { threads, reason: error.to_string() })?;
    Ok(pool.install(work))
}
