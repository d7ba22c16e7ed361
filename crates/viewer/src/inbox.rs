//! How scenes come in: files that are dropped, picked, or change where they lie.

#[cfg_attr(target_arch = "wasm32", path = "inbox/page.rs")]
#[cfg_attr(not(target_arch = "wasm32"), path = "inbox/disk.rs")]
mod place;

pub use place::CAN_PICK;
pub use place::Inbox;
