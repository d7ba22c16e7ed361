//! Images that materials name, and how they are read (SPEC 7).

use crate::options::TextureFilter;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_image::Image;

/// A picture whose texels are looked up by (s, t): (0, 0) is the upper left, s runs right, t runs down, both wrap.
#[derive(Debug)]
pub struct Texture {
    image: Image,
}

/// The texel left of (or at) a coordinate that wraps, its right neighbour, and the weight of the latter.
fn between(coordinate: f64, size: usize) -> (usize, usize, f64) {
    let place = (coordinate - coordinate.floor()) * size as f64 - 0.5;
    let left = place.floor();
    let index = if left < 0.0 { size - 1 } else { (left as usize).min(size - 1) };
    (index, if index + 1 == size { 0 } else { index + 1 }, place - left)
}

impl Texture {
    /// A texture of this picture; an alpha channel is ignored.
    pub fn new(image: Image) -> Self {
        Self { image }
    }

    /// The bytes it holds.
    pub fn memory(&self) -> u64 {
        size_of_val(self.image.samples()) as u64
    }

    /// The picture.
    pub fn image(&self) -> &Image {
        &self.image
    }

    fn texel(&self, x: usize, y: usize) -> Vec3 {
        self.image.pixel(x, y).map_or(Vec3::ZERO, |[r, g, b, _]| Vec3::new(r.into(), g.into(), b.into()))
    }

    /// The colour at (s, t).
    pub fn color(&self, st: Vec2, filter: TextureFilter) -> Vec3 {
        if !st.is_finite() {
            return self.texel(0, 0);
        }
        let (width, height) = (self.image.width(), self.image.height());
        match filter {
            TextureFilter::Nearest => {
                let index = |c: f64, size: usize| (((c - c.floor()) * size as f64) as usize).min(size - 1);
                self.texel(index(st.x, width), index(st.y, height))
            }
            TextureFilter::Bilinear => {
                let ((left, right, u), (up, down, v)) = (between(st.x, width), between(st.y, height));
                let upper = self.texel(left, up) * (1.0 - u) + self.texel(right, up) * u;
                let lower = self.texel(left, down) * (1.0 - u) + self.texel(right, down) * u;
                upper * (1.0 - v) + lower * v
            }
        }
    }

    /// How much brighter the texture gets over one texel to the right and over one texel down, about (s, t).
    pub fn slopes(&self, st: Vec2, filter: TextureFilter) -> Vec2 {
        let brightness = |step: Vec2| self.color(st + step, filter).element_sum() / 3.0;
        let half = Vec2::new(0.5 / self.image.width() as f64, 0.5 / self.image.height() as f64);
        let (right, down) = (half.with_y(0.0), half.with_x(0.0));
        Vec2::new(brightness(right) - brightness(-right), brightness(down) - brightness(-down))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_image::Channels;

    fn texture() -> Texture {
        // Red, green above blue, white.
        let samples = vec![1., 0., 0., 0., 1., 0., 0., 0., 1., 1., 1., 1.];
        Texture::new(Image::from_samples(2, 2, Channels::Rgb, samples).expect("valid size"))
    }

    #[test]
    fn centres_corners_and_wrap() {
        let t = texture();
        for filter in [TextureFilter::Bilinear, TextureFilter::Nearest] {
            assert_eq!(t.color(Vec2::new(0.25, 0.25), filter), Vec3::X);
            assert_eq!(t.color(Vec2::new(0.75, 0.25), filter), Vec3::Y);
            assert_eq!(t.color(Vec2::new(0.25, 0.75), filter), Vec3::Z);
            assert_eq!(t.color(Vec2::new(-1.25, 7.75), filter), Vec3::ONE);
        }
        // The corner lies between all four, which wrap around it.
        assert_eq!(t.color(Vec2::ZERO, TextureFilter::Bilinear), Vec3::splat(0.5));
        assert_eq!(t.color(Vec2::new(0.5, 0.25), TextureFilter::Bilinear), Vec3::new(0.5, 0.5, 0.0));
        assert_eq!(t.color(Vec2::ZERO, TextureFilter::Nearest), Vec3::X);
    }

    #[test]
    fn slopes_are_differences_of_neighbours() {
        // Brightnesses 0 and 0.6 above 0.3 and 1.
        let samples = vec![0., 0., 0., 0.9, 0.6, 0.3, 0.3, 0.3, 0.3, 1., 1., 1.];
        let t = Texture::new(Image::from_samples(2, 2, Channels::Rgb, samples).expect("valid size"));
        let slopes = |s: f64, y: f64| t.slopes(Vec2::new(s, y), TextureFilter::Bilinear);
        let near = |a: Vec2, x: f64, y: f64| (a - Vec2::new(x, y)).length() < 1e-6;
        // Between the two texels of the upper row, and between those of the left column.
        assert!(near(slopes(0.5, 0.25), 0.6, 0.0), "{}", slopes(0.5, 0.25));
        assert!(near(slopes(0.25, 0.5), 0.0, 0.3), "{}", slopes(0.25, 0.5));
        // In the middle of all four.
        assert!(near(slopes(0.5, 0.5), 0.65, 0.35), "{}", slopes(0.5, 0.5));
        // Where the picture wraps around, it falls again.
        assert!(near(slopes(1.0, 0.25), -0.6, 0.0), "{}", slopes(1.0, 0.25));
    }

    #[test]
    fn extremes_do_not_panic() {
        let t = texture();
        for x in [1e300, -1e300, -1e-300, 0.999_999_999_999_999_9, f64::INFINITY, -0.0] {
            for filter in [TextureFilter::Bilinear, TextureFilter::Nearest] {
                assert!(t.color(Vec2::new(x, x), filter).is_finite());
                assert!(t.slopes(Vec2::new(x, x), filter).is_finite());
            }
        }
    }
}
