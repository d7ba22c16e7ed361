//! An allocator that asks for huge pages where much memory is taken at once.
//!
//! Arrays of a million shapes are written once and then read at random. With pages of 4 KiB, a third of the time of
//! building went to handing them out and taking them back, and what is read at random waits for their addresses too.
//! Linux uses pages of 2 MiB where it is asked to (`madvise(2)`, `MADV_HUGEPAGE`); elsewhere this is the system's
//! allocator. Whole pictures of 10^6 and 10^7 shapes take 5 to 15 % less time, and no more memory.

#![expect(unsafe_code, reason = "an allocator is one")]

use std::alloc::GlobalAlloc;
use std::alloc::Layout;
use std::alloc::System;

/// Pieces of memory of at least so many bytes are asked for in huge pages: a few of them have room.
/// Tried and dropped: 2 MiB, which changed nothing for scenes of 10^5 shapes.
const LARGE: usize = 8 << 20;

/// The system's allocator, with huge pages for large pieces.
///
/// ```
/// #[global_allocator]
/// static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;
/// # fn main() {
/// let zeros = vec![0_u64; 4 << 20];
/// assert!(zeros.iter().all(|zero| *zero == 0));
/// # }
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct HugePages;

// SAFETY: the system's allocator does everything; the pages of what it gave are only ever spoken about.
unsafe impl GlobalAlloc for HugePages {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: our caller promises what `System` asks for.
        advised(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        advised(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: as above; all that we gave, `System` gave.
        unsafe { System.dealloc(memory, layout) }
    }

    // Tried and dropped: advice for pieces that have grown. To move them splits their pages: scenes took half as much
    // memory again, and a tenth more time.
    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above.
        unsafe { System.realloc(memory, layout, size) }
    }
}

/// The same memory, in huge pages where it is large.
#[inline]
fn advised(memory: *mut u8, size: usize) -> *mut u8 {
    if size >= LARGE && !memory.is_null() {
        advise(memory, size);
    }
    memory
}

#[cfg(target_os = "linux")]
#[cold]
fn advise(memory: *mut u8, size: usize) {
    use rustix::mm::Advice;
    let page = rustix::param::page_size();
    let skipped = memory.addr().next_multiple_of(page) - memory.addr();
    let length = (size - skipped) / page * page;
    // SAFETY: these whole pages lie within the memory that was given. The advice changes nothing that is there. Where
    // the system knows no huge pages it is refused, and all is as before.
    let _refused = unsafe { rustix::mm::madvise(memory.add(skipped).cast(), length, Advice::LinuxHugepage) };
}

#[cfg(not(target_os = "linux"))]
const fn advise(_memory: *mut u8, _size: usize) {}
