//! What is in a scene, in numbers.

use crate::bounds::world_bounds;
use crate::model::Camera;
use crate::model::Light;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::number::General;
use crate::resolved::Resolved;
use crate::resolved::TreeEvent;
use crate::walk::DEFAULT_STEPS;
use crate::walk::Step;
use crate::walk::Walk;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;
use std::fmt;
use std::path::PathBuf;

/// Shapes by kind, instances counted as often as they stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShapeCounts {
    /// Spheres.
    pub spheres: u64,
    /// Boxes.
    pub boxes: u64,
    /// Cylinders.
    pub cylinders: u64,
    /// Cones.
    pub cones: u64,
    /// Triangles with their own corners.
    pub triangles: u64,
    /// Triangles of shared vertices.
    pub indexed_triangles: u64,
    /// Tori.
    pub tori: u64,
    /// Cylinders and cones without their discs.
    pub open: u64,
}

impl ShapeCounts {
    /// All shapes.
    pub fn total(&self) -> u64 {
        self.spheres
            + self.boxes
            + self.cylinders
            + self.cones
            + self.triangles
            + self.indexed_triangles
            + self.tori
            + self.open
    }

    fn add(&mut self, kind: ShapeKind, count: u64) {
        let place = match kind {
            ShapeKind::Sphere => &mut self.spheres,
            ShapeKind::Cuboid => &mut self.boxes,
            ShapeKind::Cylinder => &mut self.cylinders,
            ShapeKind::Cone => &mut self.cones,
            ShapeKind::Triangle => &mut self.triangles,
            ShapeKind::IndexedTriangle => &mut self.indexed_triangles,
            ShapeKind::Torus => &mut self.tori,
            ShapeKind::Open => &mut self.open,
        };
        *place += count;
    }
}

/// Lights by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightCounts {
    /// Point lights.
    pub point: u64,
    /// Spot lights.
    pub spot: u64,
    /// Directional lights.
    pub directional: u64,
    /// Discs.
    pub area: u64,
}

impl LightCounts {
    /// All lights.
    pub fn total(&self) -> u64 {
        self.point + self.spot + self.directional + self.area
    }

    fn add(&mut self, light: &Light) {
        let place = match light {
            Light::Point { .. } => &mut self.point,
            Light::Spot { .. } => &mut self.spot,
            Light::Directional { .. } => &mut self.directional,
            Light::Area { .. } => &mut self.area,
        };
        *place += 1;
    }
}

/// A scene in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Shapes by kind.
    pub shapes: ShapeCounts,
    /// Groups, instances expanded; without the root.
    pub groups: u64,
    /// Instances, those inside instances included.
    pub instances: u64,
    /// Groups and instances around the deepest place.
    pub max_depth: u64,
    /// Lights by kind.
    pub lights: LightCounts,
    /// Materials of all files, without the default material.
    pub materials: u64,
    /// Shared vertices of all files.
    pub vertices: u64,
    /// The names of the textures as written.
    pub textures: Vec<String>,
    /// The scene's files; the first one is the file asked for.
    pub files: Vec<PathBuf>,
    /// A box around every shape in world coordinates; empty without shapes.
    pub bounds: Aabb,
    /// The camera in use.
    pub camera: Camera,
    /// Whether no file says so.
    pub camera_is_default: bool,
    /// The colour of a ray that hits nothing.
    pub background: Vec3,
    /// The global ambient light.
    pub ambient: Vec3,
}

/// Counts what is in a scene.
pub fn summarize(scene: &Resolved) -> Summary {
    let mut shapes = ShapeCounts::default();
    scene.runs.iter().for_each(|run| shapes.add(run.kind, u64::from(run.count)));
    let mut lights = LightCounts::default();
    scene.lights.iter().for_each(|light| lights.add(light));
    let (groups, instances) = count_nodes(&scene.files);
    Summary {
        shapes,
        groups,
        instances,
        max_depth: max_depth(&scene.tree),
        lights,
        materials: (scene.materials.len() as u64).saturating_sub(1),
        vertices: scene.files.iter().map(|file| file.vertices.len() as u64).sum(),
        textures: scene.textures.iter().map(|texture| texture.name.clone()).collect(),
        files: scene.files.iter().map(|file| file.path.clone()).collect(),
        bounds: world_bounds(scene),
        camera: scene.camera,
        camera_is_default: scene.files.first().is_none_or(|file| file.camera.is_none()),
        background: scene.background,
        ambient: scene.ambient,
    }
}

fn count_nodes(files: &[SceneFile]) -> (u64, u64) {
    let (mut groups, mut instances) = (0, 0);
    for step in Walk::new(files, DEFAULT_STEPS) {
        match step {
            Ok(Step::OpenGroup { .. }) => groups += 1,
            Ok(Step::OpenInstance { .. }) => instances += 1,
            Ok(Step::CloseGroup | Step::CloseInstance | Step::Shapes { .. }) | Err(_) => {}
        }
    }
    (groups, instances)
}

fn max_depth(tree: &[TreeEvent]) -> u64 {
    let (mut depth, mut deepest) = (0_u64, 0);
    for event in tree {
        match event {
            TreeEvent::Open => depth += 1,
            TreeEvent::Close => depth = depth.saturating_sub(1),
            TreeEvent::Run(_) => {}
        }
        deepest = deepest.max(depth);
    }
    deepest
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "file        {}", file.display())?;
        }
        let ShapeCounts { spheres, boxes, cylinders, cones, triangles, indexed_triangles, tori, open } =
            self.shapes;
        let kinds = parts(&[
            (spheres, "sphere", "spheres"),
            (boxes, "box", "boxes"),
            (cylinders, "cylinder", "cylinders"),
            (cones, "cone", "cones"),
            (triangles, "triangle", "triangles"),
            (indexed_triangles, "indexed triangle", "indexed triangles"),
            (tori, "torus", "tori"),
            (open, "open cylinder or cone", "open cylinders and cones"),
        ]);
        writeln!(f, "shapes      {}{kinds}", self.shapes.total())?;
        writeln!(f, "vertices    {}", self.vertices)?;
        writeln!(
            f,
            "groups      {} (instances {}, deepest {})",
            self.groups, self.instances, self.max_depth
        )?;
        let LightCounts { point, spot, directional, area } = self.lights;
        let kinds = parts(&[
            (point, "point", "point"),
            (spot, "spot", "spot"),
            (directional, "directional", "directional"),
            (area, "area", "area"),
        ]);
        writeln!(f, "lights      {}{kinds}", self.lights.total())?;
        writeln!(f, "materials   {}", self.materials)?;
        let names =
            if self.textures.is_empty() { String::new() } else { format!(" ({})", self.textures.join(", ")) };
        writeln!(f, "textures    {}{names}", self.textures.len())?;
        if self.bounds.is_empty() {
            writeln!(f, "bounds      none")?;
        } else {
            writeln!(f, "bounds      {} to {}", point_text(self.bounds.min), point_text(self.bounds.max))?;
        }
        let Camera { position, direction, up, half_angle } = self.camera;
        let origin = if self.camera_is_default { " (default)" } else { "" };
        let [position, direction, up] = [position, direction, up].map(point_text);
        let half_angle = General(half_angle);
        writeln!(
            f,
            "camera      at {position} towards {direction}, up {up}, half angle {half_angle}{origin}"
        )?;
        writeln!(f, "background  {}", point_text(self.background))?;
        writeln!(f, "ambient     {}", point_text(self.ambient))
    }
}

/// ` (2 spheres, 1 box)`, or nothing.
fn parts(counts: &[(u64, &str, &str)]) -> String {
    let words: Vec<String> = counts
        .iter()
        .filter(|(count, ..)| *count > 0)
        .map(|(count, one, many)| format!("{count} {}", if *count == 1 { one } else { many }))
        .collect();
    if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) }
}

fn point_text(point: Vec3) -> String {
    format!("({})", point.to_array().map(|number| General(number).to_string()).join(", "))
}
