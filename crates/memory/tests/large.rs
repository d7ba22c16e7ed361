//! Large pieces of memory as a program sees them that has chosen the allocator.

#[global_allocator]
static ALLOCATOR: dotray_memory::HugePages = dotray_memory::HugePages;

/// What a place of an array holds.
fn value(index: usize) -> u64 {
    (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

#[test]
fn arrays_grow_and_shrink_and_keep_what_they_hold() {
    // From a few bytes to 32 MiB and back: small pieces, large ones, and all ways from one to the other.
    let mut array = Vec::new();
    for index in 0..4 << 20 {
        array.push(value(index));
    }
    for length in [4 << 20, 3_000_001, 1 << 20, 77_777, 3] {
        array.truncate(length);
        array.shrink_to_fit();
        assert!(array.iter().enumerate().all(|(index, found)| *found == value(index)), "{length}");
    }
    for length in [100, 1 << 20, 5_000_000] {
        assert!(vec![0_u64; length].iter().all(|zero| *zero == 0), "{length}");
    }
}

#[cfg(target_os = "linux")]
mod linux {
    /// Whether the pages of an address are asked for as huge ones.
    fn is_advised(address: usize) -> bool {
        let maps = std::fs::read_to_string("/proc/self/smaps").expect("the process's own pages");
        let mut here = false;
        for line in maps.lines() {
            let range = line.split_whitespace().next().and_then(|word| word.split_once('-'));
            let ends = range.and_then(|(low, high)| {
                Some((usize::from_str_radix(low, 16).ok()?, usize::from_str_radix(high, 16).ok()?))
            });
            match ends {
                Some((low, high)) => here = (low..high).contains(&address),
                None if here && line.starts_with("VmFlags:") => {
                    return line.split_whitespace().any(|f| f == "hg");
                }
                None => {}
            }
        }
        false
    }

    #[test]
    fn large_pieces_are_asked_for_in_huge_pages() {
        if !std::path::Path::new("/sys/kernel/mm/transparent_hugepage/enabled").exists() {
            eprintln!("skipped, a system without huge pages");
            return;
        }
        let middle = |array: &Vec<u64>| array.as_ptr().addr() + array.len() * 4;
        let zeros = vec![0_u64; 2 << 20];
        assert!(is_advised(middle(&zeros)), "zeros");
        let ones = vec![1_u64; 2 << 20];
        assert!(is_advised(middle(&ones)), "written ones");
        let small = vec![1_u64; 1000];
        assert!(!is_advised(middle(&small)), "a small piece");
    }
}
