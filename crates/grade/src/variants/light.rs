//! Wrong lights.

use dotray_scene::Resolved;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Light;
use std::f64::consts::PI;

pub fn unlit(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.lights.clear();
}

pub fn one_light(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.lights.truncate(1);
}

pub fn directions_reversed(resolved: &mut Resolved, _: (u32, u32)) {
    for light in &mut resolved.lights {
        match light {
            Light::Spot { direction, .. } | Light::Directional { direction, .. } => *direction = -*direction,
            Light::Point { .. } | Light::Area { .. } => {}
        }
    }
}

fn attenuations(resolved: &mut Resolved, change: impl Fn(&mut Attenuation)) {
    for light in &mut resolved.lights {
        match light {
            Light::Point { attenuation, .. }
            | Light::Spot { attenuation, .. }
            | Light::Area { attenuation, .. } => change(attenuation),
            Light::Directional { .. } => {}
        }
    }
}

pub fn no_attenuation(resolved: &mut Resolved, _: (u32, u32)) {
    attenuations(resolved, |old| *old = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 });
}

pub fn attenuation_exchanged(resolved: &mut Resolved, _: (u32, u32)) {
    attenuations(resolved, |old| std::mem::swap(&mut old.linear, &mut old.quadratic));
}

/// Changes cut-off and drop-off of every spot.
fn spots(resolved: &mut Resolved, change: impl Fn(&mut f64, &mut f64)) {
    for light in &mut resolved.lights {
        match light {
            Light::Spot { cutoff, dropoff, .. } => change(cutoff, dropoff),
            Light::Point { .. } | Light::Directional { .. } | Light::Area { .. } => {}
        }
    }
}

pub fn spot_as_point(resolved: &mut Resolved, _: (u32, u32)) {
    for light in &mut resolved.lights {
        if let Light::Spot { color, position, attenuation, .. } = *light {
            *light = Light::Point { color, position, attenuation };
        }
    }
}

pub fn spot_half(resolved: &mut Resolved, _: (u32, u32)) {
    spots(resolved, |cutoff, _| *cutoff *= 0.5);
}

pub fn spot_double(resolved: &mut Resolved, _: (u32, u32)) {
    spots(resolved, |cutoff, _| *cutoff = (2.0 * *cutoff).min(PI));
}

pub fn spot_in_degrees(resolved: &mut Resolved, _: (u32, u32)) {
    spots(resolved, |cutoff, _| *cutoff *= PI / 180.0);
}

pub fn spot_without_dropoff(resolved: &mut Resolved, _: (u32, u32)) {
    spots(resolved, |_, dropoff| *dropoff = 0.0);
}

pub fn spot_exponent(resolved: &mut Resolved, _: (u32, u32)) {
    spots(resolved, |_, dropoff| *dropoff /= 128.0);
}

pub fn area_as_point(resolved: &mut Resolved, _: (u32, u32)) {
    for light in &mut resolved.lights {
        if let Light::Area { color, position, attenuation, .. } = *light {
            *light = Light::Point { color, position, attenuation };
        }
    }
}

pub fn area_on_both_sides(resolved: &mut Resolved, _: (u32, u32)) {
    let reversed: Vec<Light> = resolved
        .lights
        .iter()
        .filter_map(|light| match *light {
            Light::Area { color, position, direction, radius, attenuation } => {
                Some(Light::Area { color, position, direction: -direction, radius, attenuation })
            }
            Light::Point { .. } | Light::Spot { .. } | Light::Directional { .. } => None,
        })
        .collect();
    resolved.lights.extend(reversed);
}
