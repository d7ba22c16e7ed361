//! rayview: a scene on the screen, rasterised at once and then traced.
//!
//! What stands here without the feature `screen` needs no window and no GPU: the camera under the hand,
//! shapes laid down as a GPU wants them, the tree and its search, editing numbers in the text, tracing from coarse to
//! fine, and the rays of a pixel as lines. The feature adds what draws and what listens.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod navigate;

pub mod edit;

pub mod hidden;

pub mod pictures;

pub mod tables;

pub mod pack;

pub mod draft;

pub mod outline;

pub mod memory;

pub mod bundle;

pub mod document;

pub mod rays;

pub mod engine;

#[cfg(not(target_arch = "wasm32"))]
pub mod letters;

pub mod wire;

pub mod clerk;

pub mod crew;

#[cfg(feature = "screen")]
pub mod gpu;

#[cfg(feature = "screen")]
pub mod host;

#[cfg(feature = "screen")]
pub mod link;

#[cfg(feature = "screen")]
pub mod state;

#[cfg(all(feature = "screen", not(target_arch = "wasm32")))]
pub mod watch;

#[cfg(feature = "screen")]
pub mod inbox;

#[cfg(feature = "screen")]
pub mod panels;

#[cfg(feature = "screen")]
pub mod viewport;

// A window's frames are its own thread's: nothing waits behind them.
#[cfg(all(feature = "screen", any(test, target_arch = "wasm32")))]
pub mod hover;

#[cfg(all(feature = "screen", target_arch = "wasm32"))]
pub mod report;

#[cfg(feature = "screen")]
pub mod app;

#[cfg(all(feature = "screen", target_arch = "wasm32"))]
pub mod worker;

#[cfg(all(feature = "screen", target_arch = "wasm32"))]
pub mod web;

#[cfg(all(feature = "page", not(target_arch = "wasm32")))]
pub mod serve;
