//! Every item is tested: the reference for the other four.

use crate::batch::Batch;
use crate::query::Queries;

/// As many rays share a block of items while it is in cache.
const RAYS: usize = 64;

/// As many items make a block.
const ITEMS: u32 = 256;

/// Shows every item to every ray, block by block.
pub fn walk(items: u32, queries: &Queries<'_>, batch: &mut dyn Batch) {
    let rays = queries.len();
    for first_ray in (0..rays).step_by(RAYS) {
        let count = RAYS.min(rays - first_ray);
        let mut bounds = [f64::NEG_INFINITY; RAYS];
        for (i, bound) in bounds[..count].iter_mut().enumerate() {
            *bound = queries.query(first_ray + i).t_max;
        }
        for first in (0..items).step_by(ITEMS as usize) {
            let block = ITEMS.min(items - first);
            for (i, bound) in bounds[..count].iter_mut().enumerate() {
                if *bound > f64::NEG_INFINITY {
                    *bound = batch.leaf_range(first_ray + i, first, block, *bound);
                }
            }
        }
        for i in 0..count {
            batch.finished(first_ray + i, 0);
        }
    }
}
