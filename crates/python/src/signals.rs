//! Long work beside a Python that still hears Ctrl-C and shows progress.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use std::thread;
use std::thread::JoinHandle;
use std::time::Duration;

/// How long Python waits between two looks.
const PAUSE: Duration = Duration::from_millis(20);

/// Does `work` on a thread of its own without Python's lock. Meanwhile signals are heard and `tick` is called; once one
/// of them fails, `cancel` is set, and the failure returned when `work` has ended.
pub fn watched<T: Send>(
    py: Python<'_>,
    cancel: &AtomicBool,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let watcher = thread::current();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let answer = work();
            watcher.unpark();
            answer
        });
        let mut fault = Ok(());
        while !worker.is_finished() {
            py.detach(|| thread::park_timeout(PAUSE));
            if fault.is_ok() {
                fault = py.check_signals().and_then(|()| tick(py));
                if fault.is_err() {
                    cancel.store(true, Ordering::Relaxed);
                }
            }
        }
        let answer = worker.join().map_err(|panic| failed(panic.as_ref()));
        fault.and(answer)
    })
}

/// The same for work that nothing can stop: on a signal it goes on unseen, and what it makes is thrown away.
pub fn awaited<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    let watcher = thread::current();
    let worker: JoinHandle<T> = thread::spawn(move || {
        let answer = work();
        watcher.unpark();
        answer
    });
    while !worker.is_finished() {
        py.detach(|| thread::park_timeout(PAUSE));
        py.check_signals()?;
    }
    worker.join().map_err(|panic| failed(panic.as_ref()))
}

fn failed(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    PyRuntimeError::new_err(format!("dotray has failed: {}", text.unwrap_or("no more is known")))
}
