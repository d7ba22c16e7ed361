//! Asking for memory before it is needed: the only file that names the library that can.
//!
//! It is a hint: where there is no such instruction (WebAssembly), or memory is at hand, it costs next to nothing.

use prefetch_index::prefetch_index;

/// Whether it is more than a hint to nobody here.
pub const HELPS: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

/// The bytes of a cache line.
const LINE: usize = 64;

/// Asks for the lines of `list[first .. first + count]`; of items much longer than a line for some lines only.
#[inline(always)]
pub fn fetch<T>(list: &[T], first: usize, count: usize) {
    let items_a_line = (LINE / size_of::<T>().max(1)).max(1);
    for item in (first..first + count).step_by(items_a_line) {
        prefetch_index(list, item);
    }
    // The line in which the last item ends; nothing happens where it lies behind the list.
    let last = (first + count).saturating_sub(usize::from(items_a_line > 1));
    prefetch_index(list, last);
}

/// Asks for the first, middle and last item of `list[first .. first + count]`, without a loop whose end could be
/// guessed wrong.
#[inline(always)]
pub fn fetch_some<T>(list: &[T], first: usize, count: usize) {
    prefetch_index(list, first);
    prefetch_index(list, first + count / 2);
    prefetch_index(list, first + count.saturating_sub(1));
}
