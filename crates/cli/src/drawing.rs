//! Orthographic views of boxes and lines as SVG: what `explain` and `tree` draw with.

use dotray::geometry::Aabb;
use dotray::geometry::Vec3;
use std::fmt::Write;

/// From where the scene is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Along −y: x to the right, z down.
    Top,
    /// Along −z: x to the right, y up.
    Front,
    /// Along −x: z to the left, y up.
    Side,
}

impl View {
    /// What its title says.
    pub fn title(self) -> &'static str {
        match self {
            Self::Top => "from above: x right, z down",
            Self::Front => "from the front: x right, y up",
            Self::Side => "from the right: z left, y up",
        }
    }

    /// Right and down in the drawing.
    fn project(self, point: Vec3) -> (f64, f64) {
        match self {
            Self::Top => (point.x, point.z),
            Self::Front => (point.x, -point.y),
            Self::Side => (-point.z, -point.y),
        }
    }
}

/// On which side of a mark its word stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Above it.
    Above,
    /// Below it.
    Below,
}

/// The edge of a view in the drawing.
const EDGE: f64 = 560.0;
const GAP: f64 = 20.0;
const TITLE: f64 = 26.0;

/// A drawing under way.
pub struct Drawing {
    views: Vec<View>,
    center: Vec3,
    /// Drawing units a unit of the scene.
    scale: f64,
    body: Vec<String>,
}

impl Drawing {
    /// Views side by side, each showing the region around `shown` at the same scale.
    pub fn new(views: &[View], shown: Aabb) -> Self {
        let shown = if shown.is_empty() { Aabb::around([Vec3::NEG_ONE, Vec3::ONE]) } else { shown };
        let reach = shown.size().max_element().max(f64::MIN_POSITIVE);
        let scale = EDGE / (1.1 * reach);
        Self {
            views: views.to_vec(),
            center: shown.center(),
            scale: if scale.is_finite() { scale } else { 1.0 },
            body: vec![String::new(); views.len()],
        }
    }

    fn place(&self, view: View, point: Vec3) -> (f64, f64) {
        let (x, y) = view.project(point - self.center);
        // Far beyond the edge all places look alike, and viewers stumble over huge numbers.
        let on_page = |offset: f64| (EDGE / 2.0 + offset * self.scale).clamp(-1e5, 1e5);
        (on_page(x), on_page(y))
    }

    fn each(&mut self, draw: impl Fn(&Self, View) -> String) {
        for index in 0..self.views.len() {
            let Some(&view) = self.views.get(index) else { continue };
            let element = draw(self, view);
            if let Some(body) = self.body.get_mut(index) {
                body.push_str(&element);
            }
        }
    }

    /// A box's outline, with a name that a pointer shows.
    pub fn outline(&mut self, bounds: &Aabb, look: &str, name: &str) {
        if bounds.is_empty() {
            return;
        }
        let name = escaped(name);
        self.each(|drawing, view| {
            let (a, b) = (drawing.place(view, bounds.min), drawing.place(view, bounds.max));
            let (x, y) = (a.0.min(b.0), a.1.min(b.1));
            // A flat box still shows as a line.
            let (width, height) = ((a.0 - b.0).abs().max(0.5), (a.1 - b.1).abs().max(0.5));
            let place = format!("x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"");
            format!("<rect {place} {look}><title>{name}</title></rect>\n")
        });
    }

    /// A line, with a name.
    pub fn line(&mut self, from: Vec3, to: Vec3, look: &str, name: &str) {
        let name = escaped(name);
        self.each(|drawing, view| {
            let ((x1, y1), (x2, y2)) = (drawing.place(view, from), drawing.place(view, to));
            let place = format!("x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\"");
            format!("<line {place} {look}><title>{name}</title></line>\n")
        });
    }

    /// A dot with a word beside it, above or below, which stays inside the view.
    pub fn mark(&mut self, at: Vec3, fill: &str, word: &str, side: Side) {
        let width = 6.5 * word.chars().count() as f64;
        let word = escaped(word);
        self.each(|drawing, view| {
            let (x, y) = drawing.place(view, at);
            let dot = format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"3.5\" fill=\"{fill}\"/>");
            let down = match side {
                Side::Above => -5.0,
                Side::Below => 14.0,
            };
            // The view's own title stands in its first line.
            let (x, y) = ((x + 5.0).min(EDGE - width - 4.0), (y + down).clamp(30.0, EDGE - 4.0));
            format!("{dot}<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"11\">{word}</text>\n")
        });
    }

    /// The whole file; `legend` is a look and a word each.
    pub fn finish(self, title: &str, legend: &[(&str, &str)]) -> String {
        let count = self.views.len() as f64;
        let (width, height) = (count * (EDGE + GAP) + GAP, EDGE + 2.0 * TITLE + 2.0 * GAP);
        let title = escaped(title);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" font-family=\"sans-serif\">\n<title>{title}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"6\" \
             markerHeight=\"6\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" fill=\"context-stroke\"/></marker>\
             </defs>\n<text x=\"{GAP}\" y=\"19\" font-size=\"14\">{title}</text>\n"
        );
        for (index, (view, body)) in self.views.iter().zip(&self.body).enumerate() {
            let left = GAP + index as f64 * (EDGE + GAP);
            let name = view.title();
            // Writing into a string cannot fail.
            let _ = write!(
                svg,
                "<svg x=\"{left}\" y=\"{TITLE}\" width=\"{EDGE}\" height=\"{EDGE}\">\n\
                 <rect width=\"100%\" height=\"100%\" fill=\"#fafafa\" stroke=\"#ccc\"/>\n{body}\
                 <text x=\"6\" y=\"16\" font-size=\"12\" fill=\"#666\">{name}</text>\n</svg>\n"
            );
        }
        let (mut x, y) = (GAP, TITLE + EDGE + 18.0);
        for (look, word) in legend {
            let word_at = x + 30.0;
            let _ = writeln!(
                svg,
                "<line x1=\"{x}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" {look}/>\
                 <text x=\"{word_at}\" y=\"{}\" font-size=\"12\">{}</text>",
                x + 25.0,
                y + 4.0,
                escaped(word)
            );
            x = word_at + 8.0 * word.chars().count() as f64 + 12.0;
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// Text that may stand in XML.
pub fn escaped(text: &str) -> String {
    let plain = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    // XML has no place for other control characters, not even escaped.
    plain.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
