//! An explanation as indented, coloured text.

use dotray::geometry::Vec3;
use dotray::render::Antialias;
use dotray::render::inspect::Branch;
use dotray::render::inspect::End;
use dotray::render::inspect::LightTerm;
use dotray::render::inspect::Meeting;
use dotray::render::inspect::RayKind;
use dotray::render::inspect::Shadow;
use dotray::scene::model::Tint;
use dotray::scene::number::General;
use dotray::scene::number::Shortest;
use std::collections::BTreeMap;

use crate::explain::Explanation;
use crate::explain::Listed;

/// Lines being written.
struct Page<'a> {
    of: &'a Explanation<'a>,
    color: bool,
    text: String,
}

const BOLD: &str = "1";
const FAINT: &str = "2";
const RED: &str = "31";
const GREEN: &str = "32";
const YELLOW: &str = "33";
const BLUE: &str = "34";

/// The whole text.
pub fn text(of: &Explanation<'_>, color: bool) -> String {
    let mut page = Page { of, color, text: String::new() };
    page.head();
    page.samples();
    let mut depths: Vec<usize> = Vec::new();
    for (number, ray) in of.rays.iter().enumerate() {
        let depth = ray.parent.and_then(|parent| depths.get(parent)).map_or(0, |depth| depth + 1);
        depths.push(depth);
        page.ray(number, ray, depth);
    }
    page.visits();
    page.verdict();
    page.text
}

fn vector(v: Vec3) -> String {
    let [x, y, z] = v.to_array().map(|x| General(x + 0.0).to_string());
    format!("({x} {y} {z})")
}

/// With all digits, for what is compared bit for bit.
fn exact(v: Vec3) -> String {
    format!("({} {} {})", Shortest(v.x), Shortest(v.y), Shortest(v.z))
}

fn g(x: f64) -> General {
    General(x + 0.0)
}

/// The name of a kind of ray.
pub fn kind_name(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Eye => "eye",
        RayKind::Reflected => "reflected",
        RayKind::Refracted => "refracted",
    }
}

impl Page<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        // A thousand bounces would otherwise be mostly blanks.
        let indent = 2 * depth.min(60);
        self.text.push_str(&" ".repeat(indent));
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn paint(&self, code: &str, text: &str) -> String {
        if self.color { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }

    /// A colour with a patch of it.
    fn patch(&self, color: Vec3) -> String {
        if !self.color {
            return vector(color);
        }
        let [r, g, b] = color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        format!("{} \x1b[48;2;{r};{g};{b}m  \x1b[0m", vector(color))
    }

    fn head(&mut self) {
        let (of, options) = (self.of, self.of.options);
        let size = format!("{}x{}", options.width, options.height);
        let place = match (of.pixel, of.sampling.samples.get(of.chosen)) {
            (Some((x, y)), _) => format!("pixel {x} {y} of {size}, from the upper left"),
            (None, Some(sample)) => format!("film {},{} of {size}, from the lower left", sample.x, sample.y),
            (None, None) => size,
        };
        let title = self.paint(BOLD, &format!("{}: {place}", of.scene));
        self.line(0, &title);
        let shadows = format!("{:?}", options.shadows).to_lowercase();
        let rest = format!(
            "recursion limit {}, contribution threshold {}, shadows {shadows}, accelerator {}",
            options.recursion, options.threshold, of.accelerator
        );
        let rest = self.paint(FAINT, &rest);
        self.line(0, &rest);
        self.line(0, "");
    }

    fn samples(&mut self) {
        let of = self.of;
        let count = of.sampling.samples.len();
        if count < 2 {
            return;
        }
        let how = match of.options.antialias {
            Antialias::None => String::new(),
            Antialias::Grid(n) => format!("the mean of {n} x {n} centres of sub-pixels"),
            Antialias::Adaptive { threshold, depth } => format!(
                "{} squares; divided where corners differ by more than {threshold}, at most {depth} times",
                of.sampling.squares.len()
            ),
        };
        let title = self.paint(BOLD, &format!("{count} samples: {how}"));
        self.line(0, &title);
        for square in &of.sampling.squares {
            let (x, y) = square.corner;
            let line = format!("square at {x},{y}, edge {}, divided {} times", square.edge, square.level);
            let line = self.paint(FAINT, &line);
            self.line(1, &line);
        }
        for (number, sample) in of.sampling.samples.iter().enumerate() {
            let mark = if number == of.chosen { "*" } else { " " };
            let color = self.patch(sample.color);
            let line = format!(
                "{mark} {number:>3}  at {},{}  weight {}  {color}",
                sample.x, sample.y, sample.weight
            );
            self.line(1, &line);
        }
        let mean = format!("pixel = Σ weight · colour = {}", exact(of.sampling.mean));
        self.line(1, &mean);
        let chosen = format!("the rays of sample {} (*; --sample chooses another):", of.chosen);
        self.line(1, &chosen);
        self.line(0, "");
    }

    fn ray(&mut self, number: usize, ray: &Listed<'_>, depth: usize) {
        let node = ray.node;
        let code = match node.kind {
            RayKind::Eye => BLUE,
            RayKind::Reflected => GREEN,
            RayKind::Refracted => YELLOW,
        };
        let title = self.paint(code, &format!("ray {number}: {}", kind_name(node.kind)));
        let contribution = vector(node.contribution);
        self.line(depth, &format!("{title}, depth {}, contribution {contribution}", node.depth));
        let depth = depth + 1;
        let (origin, direction) = (vector(node.ray.origin), vector(node.ray.direction));
        self.line(depth, &format!("from {origin} along {direction}"));
        let Some(met) = &node.meeting else {
            let color = self.patch(node.color);
            self.line(depth, &format!("meets nothing: background {color}"));
            return;
        };
        self.meeting(met, depth);
        self.own_light(met, depth);
        for terms in met.lights.chunk_by(|a, b| a.light == b.light) {
            match terms {
                [term] if term.samples == 1 => self.light(term, depth),
                terms => self.area_light(terms, depth),
            }
        }
        self.branch("reflected", "kSpec·M_S", &met.reflected, ray.children[0], depth);
        self.branch("refracted", "kTrans·M_S", &met.refracted, ray.children[1], depth);
        let color = self.patch(node.color);
        self.line(depth, &format!("sum {color}"));
    }

    fn meeting(&mut self, met: &Meeting, depth: usize) {
        let of = self.of;
        let name = self.paint(BOLD, &of.shape_name(met.nearest.number));
        self.line(depth, &format!("meets {name}"));
        let depth = depth + 1;
        let place = of.shapes.get(&met.nearest.number);
        for group in place.map(|place| place.groups.as_slice()).unwrap_or_default() {
            self.line(depth, &format!("in {group}"));
        }
        let material = match place.and_then(|place| place.material_place.as_ref()) {
            Some(place) => format!("material {} {place}", met.material),
            None => "the default material".to_owned(),
        };
        self.line(depth, &material);
        let point = vector(met.surface.point);
        self.line(depth, &format!("t {}, point {point}", g(met.nearest.hit.t)));
        let object = vector(met.surface.in_object.point);
        let st = met.surface.in_object.texcoord.get();
        self.line(depth, &format!("in object coordinates {object}, st ({} {})", g(st.x), g(st.y)));
        let side = if met.entering { "enters: normals stay" } else { "leaves: normals are flipped" };
        let flip = |normal: Vec3| vector(if met.entering { normal } else { -normal });
        let (before, after) = (flip(met.normal), vector(met.normal));
        self.line(depth, &format!("{side}; n̂ before {before}, after {after}"));
        if met.geometric_normal != met.normal {
            let (before, after) = (flip(met.geometric_normal), vector(met.geometric_normal));
            self.line(depth, &format!("the shape's own normal before {before}, after {after}"));
        }
        self.line(depth, &format!("r̂ {}", vector(met.mirrored)));
    }

    fn own_light(&mut self, met: &Meeting, depth: usize) {
        let Some(material) = self.of.resolved.materials.get(met.material as usize) else { return };
        let parts = [material.emissive, met.ambient, self.of.resolved.ambient, met.texture].map(vector);
        let [emissive, ambient, global, texture] = parts;
        let sum = self.patch(met.own_light);
        let line = format!("M_E + M_A·L_G·T_C = {emissive} + {ambient}·{global}·{texture} = {sum}");
        self.line(depth, &line);
    }

    fn light_title(&mut self, term: &LightTerm, depth: usize, rest: &str) {
        let name = match self.of.lights.get(term.light as usize) {
            Some(place) => format!("light {}: {} {}", term.light, place.kind, place.place),
            None => format!("light {}", term.light),
        };
        let name = self.paint(BOLD, &name);
        self.line(depth, &format!("{name}{rest}"));
    }

    fn light(&mut self, term: &LightTerm, depth: usize) {
        self.light_title(term, depth, "");
        let depth = depth + 1;
        let Some(incident) = &term.incident else {
            return self.line(depth, "sends nothing here (outside of its cone, or behind it)");
        };
        let towards = vector(incident.towards);
        let away = g(incident.distance);
        self.line(depth, &format!("L̂ {towards}, distance {away}, n̂·L̂ {}", g(term.cosine)));
        if term.cosine <= 0.0 {
            return self.line(depth, "adds 0: the point faces away");
        }
        if let Some(light) = self.of.world.lights().get(term.light as usize) {
            let (spot, attenuation) = light.factors(incident);
            let (color, strength) = (vector(light.color()), vector(incident.strength));
            let factors = format!("F_SPOT {} · F_ATTEN {}", g(spot), g(attenuation));
            self.line(depth, &format!("L {color} · {factors} = {strength}"));
        }
        let (diffuse, highlight) = (vector(term.diffuse), vector(term.highlight));
        self.line(depth, &format!("M_D·T_C·(n̂·L̂) = {diffuse}"));
        self.line(depth, &format!("M_S·max(0, r̂·L̂)^(128·kSpec) = {highlight}"));
        let tint = self.of.resolved.tints.get(term.light as usize).filter(|tint| **tint != Tint::PLAIN);
        if let Some(tint) = tint {
            let (diffuse, specular) = (vector(tint.diffuse), vector(tint.specular));
            self.line(depth, &format!("the light's own tint: diffuse {diffuse}, specular {specular}"));
        }
        let shadow = self.shadow(&term.shadow);
        self.line(depth, &format!("S {}: {shadow}", vector(term.filter)));
        let added = self.patch(term.lit * term.filter);
        self.line(depth, &format!("adds {added}"));
    }

    fn shadow(&self, shadow: &Shadow) -> String {
        match shadow {
            Shadow::NotAsked => "no shadow ray is sent".to_owned(),
            Shadow::Blocked { number, .. } => {
                self.paint(RED, &format!("blocked by {}", self.of.shape_name(*number)))
            }
            Shadow::Crossed(crossings) if crossings.is_empty() => self.paint(GREEN, "nothing lies between"),
            Shadow::Crossed(crossings) => {
                let through = crossings.iter().map(|(crossing, filter)| {
                    let name = self.of.shape_name(crossing.number);
                    format!("{name} at t {} lets {} through", g(crossing.hit.t), vector(*filter))
                });
                self.paint(YELLOW, &through.collect::<Vec<_>>().join("; "))
            }
        }
    }

    /// The samples of an area light: how many get through, and what is in their way.
    fn area_light(&mut self, terms: &[LightTerm], depth: usize) {
        let Some(first) = terms.first() else { return };
        self.light_title(first, depth, &format!(" in {} samples", first.samples));
        let depth = depth + 1;
        let (mut nothing, mut free, mut filtered) = (0, 0, 0);
        let mut blockers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut sum = Vec3::ZERO;
        for term in terms {
            match &term.shadow {
                Shadow::NotAsked if term.lit == Vec3::ZERO => nothing += 1,
                Shadow::NotAsked => free += 1,
                Shadow::Blocked { number, .. } => *blockers.entry(*number).or_default() += 1,
                Shadow::Crossed(crossings) if crossings.is_empty() => free += 1,
                Shadow::Crossed(_) => filtered += 1,
            }
            if term.lit != Vec3::ZERO {
                sum += term.lit * term.filter;
            }
        }
        self.line(
            depth,
            &format!(
                "{free} reach the point, {filtered} through see-through surfaces, {nothing} give nothing"
            ),
        );
        for (number, count) in blockers {
            let name = self.paint(RED, &format!("blocked by {}", self.of.shape_name(number)));
            self.line(depth, &format!("{count} {name}"));
        }
        let mean = self.patch(sum / f64::from(first.samples));
        self.line(depth, &format!("their mean adds {mean} (each sample is told with --format json)"));
    }

    fn branch(&mut self, name: &str, weight: &str, branch: &Branch, child: Option<usize>, depth: usize) {
        let line = match branch {
            Branch::Traced(node) => {
                let child = child.map_or_else(String::new, |child| format!(" of ray {child}"));
                let (factor, color) = (vector(node.weight), vector(node.color));
                let added = self.patch(branch.color());
                format!("{name}: {weight} {factor} · colour {color}{child} = {added}")
            }
            Branch::Ended(end) => format!("{name}: {}", end_text(*end, self.of.options.threshold)),
        };
        self.line(depth, &line);
    }

    fn visits(&mut self) {
        if self.of.visits.is_empty() {
            return;
        }
        let (bold, faint) = ("tests of all rays (of the eye ray alone)", "boxes also counts cells");
        let title = self.paint(BOLD, bold);
        self.line(0, &format!("\n{title}; {faint}"));
        for visit in &self.of.visits {
            let same = if visit.same_color { "same colour" } else { "OTHER COLOUR" };
            let boxes = format!("{} ({}) boxes", visit.boxes, visit.eye_boxes);
            let shapes = format!("{} ({}) shapes", visit.shapes, visit.eye_shapes);
            self.line(1, &format!("{:<7} {boxes:>20} {shapes:>22}  {same}", visit.accelerator));
        }
    }

    fn verdict(&mut self) {
        let of = self.of;
        self.line(0, "");
        let eye = of.rays.first().map_or(Vec3::ZERO, |ray| ray.node.color);
        let rays = of.rays.len();
        let sums = if of.sums_agree() {
            self.paint(GREEN, "agree bit for bit")
        } else {
            self.paint(RED, "DO NOT AGREE")
        };
        self.line(0, &format!("the terms of {rays} rays and their colours {sums}: {}", exact(eye)));
        let (Some(pixel), Some(agrees)) = (of.rendered, of.pixel_agrees()) else { return };
        let same =
            if agrees { self.paint(GREEN, "the same bit for bit") } else { self.paint(RED, "NOT THE SAME") };
        let [r, g, b] = pixel;
        self.line(0, &format!("the rendered pixel, in single precision, is {same}: ({r:?} {g:?} {b:?})"));
    }
}

fn end_text(end: End, threshold: f64) -> String {
    match end {
        End::Limit => "ended, the recursion limit is reached".to_owned(),
        End::NoWeight => "none, the material sends no such ray".to_owned(),
        End::Threshold { largest } => {
            format!("ended, its contribution {} lies below the threshold {threshold}", g(largest))
        }
        End::TotalReflection => "none, total internal reflection".to_owned(),
    }
}
