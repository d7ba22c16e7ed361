//! Scenes without the parser: each test writes down the tree it is about.

use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat4;
use dotray_geometry::Sphere;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use dotray_scene::model::Camera;
use dotray_scene::model::Include;
use dotray_scene::model::Item;
use dotray_scene::model::Light;
use dotray_scene::model::Material;
use dotray_scene::model::Placed;
use dotray_scene::model::Scene;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeKind;
use dotray_scene::model::ShapeList;
use dotray_scene::model::Vertex;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;

/// A file under construction. Each directive takes ten bytes of an imaginary text.
pub struct Build {
    pub file: SceneFile,
    number: u32,
    at: u64,
}

impl Build {
    /// An empty file of this number.
    pub fn file(number: u32) -> Self {
        let path = format!("scenes/{number}.ray").into();
        Self { file: SceneFile { path, ..SceneFile::default() }, number, at: 0 }
    }

    /// The place of the next directive.
    fn span(&mut self) -> Span {
        self.at += 10;
        Span { file: FileId(self.number), start: self.at - 10, end: self.at }
    }

    pub fn camera(mut self) -> Self {
        let camera = Camera {
            position: Vec3::new(0.0, 0.0, 4.0),
            direction: Vec3::NEG_Z,
            up: Vec3::Y,
            half_angle: 0.523,
        };
        let span = self.span();
        self.file.camera = Some(Placed { value: camera, span });
        self
    }

    pub fn light(mut self) -> Self {
        let value = Light::Directional { color: Vec3::ONE, direction: Vec3::NEG_Y };
        let span = self.span();
        self.file.lights.push(Placed { value, span });
        self
    }

    pub fn material(mut self, change: impl Fn(&mut Material)) -> Self {
        let mut value = Material {
            ambient: Vec3::splat(0.1),
            diffuse: Vec3::splat(0.2),
            specular: Vec3::new(0.25, 0.5, 1.0),
            emissive: Vec3::splat(0.4),
            k_specular: 0.5,
            k_transmission: 0.0,
            index_of_refraction: 1.0,
            texture: None,
            bump: None,
            text: String::new(),
            weights: None,
        };
        change(&mut value);
        let span = self.span();
        self.file.materials.push(Placed { value, span });
        self
    }

    pub fn texture(mut self, name: &str) -> Self {
        let span = self.span();
        self.file.textures.push(Placed { value: name.to_owned(), span });
        self
    }

    pub fn include(mut self, file: u32) -> Self {
        let span = self.span();
        let value = Include { name: format!("{file}.ray"), file: FileId(file) };
        self.file.includes.push(Placed { value, span });
        self
    }

    pub fn instance(mut self, include: u32) -> Self {
        self.span();
        self.file.items.push(Item::Instance(include));
        self
    }

    /// Opens a group with a matrix given row by row.
    pub fn open(mut self, rows: [[f64; 4]; 4]) -> Self {
        let span = self.span();
        self.file.items.push(Item::Open(self.file.groups.len() as u32));
        self.file.groups.push(Placed { value: Mat4::from_cols_array_2d(&rows).transpose(), span });
        self
    }

    pub fn translate(self, x: f64, y: f64, z: f64) -> Self {
        self.open([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]])
    }

    pub fn scale(self, x: f64, y: f64, z: f64) -> Self {
        self.open([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], [0.0, 0.0, 0.0, 1.0]])
    }

    pub fn close(mut self) -> Self {
        self.span();
        self.file.items.push(Item::Close);
        self
    }

    pub fn sphere(self, material: i32, center: [f64; 3], radius: f64) -> Self {
        let sphere = Sphere::new(Vec3::from(center), radius).unwrap();
        self.shape(ShapeKind::Sphere, material, sphere, |file| &mut file.spheres)
    }

    pub fn cuboid(self, material: i32, center: [f64; 3], size: [f64; 3]) -> Self {
        let cuboid = Cuboid::new(Vec3::from(center), Vec3::from(size)).unwrap();
        self.shape(ShapeKind::Cuboid, material, cuboid, |file| &mut file.cuboids)
    }

    pub fn cylinder(self, material: i32, center: [f64; 3], radius: f64, height: f64) -> Self {
        let cylinder = Cylinder::new(Vec3::from(center), radius, height).unwrap();
        self.shape(ShapeKind::Cylinder, material, cylinder, |file| &mut file.cylinders)
    }

    pub fn cone(self, material: i32, center: [f64; 3], radius: f64, height: f64) -> Self {
        let cone = Cone::new(Vec3::from(center), radius, height).unwrap();
        self.shape(ShapeKind::Cone, material, cone, |file| &mut file.cones)
    }

    pub fn triangle(self, material: i32, v: [[f64; 3]; 3], n: [[f64; 3]; 3], t: [[f64; 2]; 3]) -> Self {
        let triangle = Triangle::new(v.map(Vec3::from), n.map(Vec3::from), t.map(Vec2::from)).unwrap();
        self.shape(ShapeKind::Triangle, material, triangle, |file| &mut file.triangles)
    }

    pub fn vertex(mut self, position: [f64; 3], normal: [f64; 3], texcoord: [f64; 2]) -> Self {
        self.span();
        let vertex = Vertex {
            position: Vec3::from(position),
            normal: Vec3::from(normal),
            texcoord: Vec2::from(texcoord),
        };
        self.file.vertices.push(vertex);
        self
    }

    pub fn indexed(self, material: i32, corners: [u32; 3]) -> Self {
        self.shape(ShapeKind::IndexedTriangle, material, corners, |file| &mut file.indexed_triangles)
    }

    fn shape<T>(
        mut self,
        kind: ShapeKind,
        material: i32,
        shape: T,
        list: impl Fn(&mut SceneFile) -> &mut ShapeList<T>,
    ) -> Self {
        let span = self.span();
        let list = list(&mut self.file);
        list.shapes.push(shape);
        list.materials.push(material);
        list.starts.push(span.start);
        let count_before = list.shapes.len() as u32 - 1;
        match self.file.items.last_mut() {
            Some(Item::Run { kind: last, count, .. }) if *last == kind => *count += 1,
            _ => self.file.items.push(Item::Run { kind, first: count_before, count: 1 }),
        }
        self
    }
}

/// A scene of these files, which are numbered in this order.
pub fn scene<const N: usize>(files: [Build; N]) -> Scene {
    Scene { files: files.map(|build| build.file).into() }
}
