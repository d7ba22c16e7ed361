//! What neighbouring tiles have in common.

use crate::sampler::LatticePoint;
use crate::sampler::Sample;
use std::collections::HashMap;
use std::sync::Condvar;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::Duration;

/// How long a tile waits for another before it asks whether it should stop.
const PATIENCE: Duration = Duration::from_millis(10);

/// Samples on the borders of tiles, so that two tiles that share one trace it once. `None` is a claim: some tile
/// is about to publish the colour.
#[derive(Debug)]
pub struct Borders<T> {
    known: Mutex<HashMap<LatticePoint, Option<T>>>,
    published: Condvar,
}

/// A tile's claims; given up should the tile fail before it publishes, so that nobody waits for ever.
struct Claims<'a, T: Sample> {
    borders: &'a Borders<T>,
    points: Vec<LatticePoint>,
}

impl<T: Sample> Drop for Claims<'_, T> {
    fn drop(&mut self) {
        let mut known = self.borders.known.lock().unwrap_or_else(PoisonError::into_inner);
        for point in &self.points {
            if known.get(point) == Some(&None) {
                known.remove(point);
            }
        }
        self.borders.published.notify_all();
    }
}

impl<T> Default for Borders<T> {
    fn default() -> Self {
        Self { known: Mutex::default(), published: Condvar::new() }
    }
}

impl<T: Sample> Borders<T> {
    /// The colours of `points`: those that nobody has claimed are traced and published, the others are waited for.
    /// A tile publishes what it has claimed before it waits, so two tiles never wait for each other. `None` where the
    /// work was cancelled, which `trace` says by `None`; nothing is published then.
    pub fn share(
        &self,
        points: &[LatticePoint],
        on_border: impl Fn(&LatticePoint) -> bool,
        trace: &mut impl FnMut(&[LatticePoint]) -> Option<Vec<T>>,
        cancelled: impl Fn() -> bool,
    ) -> Option<Vec<T>> {
        let mut colors: Vec<Option<T>> = vec![None; points.len()];
        let (mine, claims) = self.claim(points, on_border);
        let wanted: Vec<LatticePoint> = mine.iter().map(|&index| points[index]).collect();
        for (&index, color) in mine.iter().zip(trace(&wanted)?) {
            colors[index] = Some(color);
        }
        self.publish(claims, points.iter().zip(&colors));
        let mut all = Vec::with_capacity(points.len());
        for (point, color) in points.iter().zip(colors) {
            let known = match color {
                Some(color) => Some(color),
                None => self.wait_for(point, &cancelled)?,
            };
            all.push(match known {
                Some(color) => color,
                None => *trace(&[*point])?.first()?,
            });
        }
        Some(all)
    }

    /// The indices of the points that the caller traces, with its claims on those that others may want.
    fn claim(
        &self,
        points: &[LatticePoint],
        on_border: impl Fn(&LatticePoint) -> bool,
    ) -> (Vec<usize>, Claims<'_, T>) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let mut claims = Claims { borders: self, points: Vec::new() };
        let mut mine = Vec::with_capacity(points.len());
        for (index, point) in points.iter().enumerate() {
            if on_border(point) {
                if known.contains_key(point) {
                    continue;
                }
                known.insert(*point, None);
                claims.points.push(*point);
            }
            mine.push(index);
        }
        (mine, claims)
    }

    fn publish<'p>(
        &self,
        claims: Claims<'_, T>,
        colors: impl Iterator<Item = (&'p LatticePoint, &'p Option<T>)>,
    ) where
        T: 'p,
    {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        for (point, color) in colors {
            if let Some(entry @ None) = known.get_mut(point) {
                *entry = *color;
            }
        }
        drop(known);
        drop(claims);
    }

    /// The colour that another tile publishes: inside, `None` where it gave up; outside, where this one was cancelled.
    fn wait_for(&self, point: &LatticePoint, cancelled: &impl Fn() -> bool) -> Option<Option<T>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            match known.get(point) {
                Some(Some(color)) => return Some(Some(*color)),
                Some(None) if cancelled() => return None,
                Some(None) => {
                    let waited = self.published.wait_timeout(known, PATIENCE);
                    known = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
                None => return Some(None),
            }
        }
    }
}
