//! A wall around decoders and encoders of other crates.

use std::panic::AssertUnwindSafe;
use std::panic::catch_unwind;

/// Runs code of another crate; if that panics, which would be a defect there, its message becomes an ordinary error.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    // What the closure touches is dropped or returned whole, so nothing broken can be seen afterwards.
    let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        Err(format!("the library for it broke down: {}", text.unwrap_or_default()))
    });
    result.map_err(|message| presentable(&message))
}

/// Other crates put lists and bytes of the file into their messages: cut to one line of bounded length.
fn presentable(message: &str) -> String {
    const MOST_LETTERS: usize = 240;
    let mut line: String = message
        .chars()
        .map(|letter| if letter.is_control() { ' ' } else { letter })
        .take(MOST_LETTERS)
        .collect();
    if message.chars().nth(MOST_LETTERS).is_some() {
        line.push('…');
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_become_errors() {
        let broken: Result<(), String> = guarded(|| panic!("index {} out of bounds", 7));
        assert_eq!(broken.unwrap_err(), "the library for it broke down: index 7 out of bounds");
        assert_eq!(guarded(|| Ok(3)), Ok(3));
    }

    #[test]
    fn long_messages_are_cut() {
        let long: Result<(), String> = guarded(|| Err("é\n".repeat(500)));
        let message = long.unwrap_err();
        assert_eq!(message.chars().count(), 241);
        assert!(message.starts_with("é é ") && message.ends_with('…'));
    }
}
