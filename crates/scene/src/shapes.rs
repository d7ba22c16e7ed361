//! The shapes of a file by their kind.

use crate::dialect::Dialect;
use crate::model::Color;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::span::FileId;
use crate::span::Span;
use dotray_geometry::OpenSide;
use dotray_geometry::Shape;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;

impl ShapeKind {
    /// Every kind.
    pub const ALL: [Self; 8] = [
        Self::Sphere,
        Self::Cuboid,
        Self::Cylinder,
        Self::Cone,
        Self::Triangle,
        Self::IndexedTriangle,
        Self::Torus,
        Self::Open,
    ];

    /// The directive that makes such a shape.
    pub const fn directive(self) -> &'static str {
        match self {
            Self::Sphere => "#shape_sphere",
            Self::Cuboid => "#shape_box",
            Self::Cylinder => "#shape_cylinder",
            Self::Cone => "#shape_cone",
            Self::Triangle | Self::IndexedTriangle => "#shape_triangle",
            Self::Torus => "#shape_torus",
            Self::Open => "#shape_side",
        }
    }
}

impl SceneFile {
    /// How many shapes of a kind stand in the file.
    pub fn shape_count(&self, kind: ShapeKind) -> usize {
        match kind {
            ShapeKind::Sphere => self.spheres.shapes.len(),
            ShapeKind::Cuboid => self.cuboids.shapes.len(),
            ShapeKind::Cylinder => self.cylinders.shapes.len(),
            ShapeKind::Cone => self.cones.shapes.len(),
            ShapeKind::Triangle => self.triangles.shapes.len(),
            ShapeKind::IndexedTriangle => self.indexed_triangles.shapes.len(),
            ShapeKind::Torus => self.tori.shapes.len(),
            ShapeKind::Open => self.open_sides.shapes.len(),
        }
    }

    /// The material numbers of the shapes of a kind, as written.
    pub fn shape_materials(&self, kind: ShapeKind) -> &[i32] {
        match kind {
            ShapeKind::Sphere => &self.spheres.materials,
            ShapeKind::Cuboid => &self.cuboids.materials,
            ShapeKind::Cylinder => &self.cylinders.materials,
            ShapeKind::Cone => &self.cones.materials,
            ShapeKind::Triangle => &self.triangles.materials,
            ShapeKind::IndexedTriangle => &self.indexed_triangles.materials,
            ShapeKind::Torus => &self.tori.materials,
            ShapeKind::Open => &self.open_sides.materials,
        }
    }

    /// The same, to be changed.
    pub fn shape_materials_mut(&mut self, kind: ShapeKind) -> &mut Vec<i32> {
        match kind {
            ShapeKind::Sphere => &mut self.spheres.materials,
            ShapeKind::Cuboid => &mut self.cuboids.materials,
            ShapeKind::Cylinder => &mut self.cylinders.materials,
            ShapeKind::Cone => &mut self.cones.materials,
            ShapeKind::Triangle => &mut self.triangles.materials,
            ShapeKind::IndexedTriangle => &mut self.indexed_triangles.materials,
            ShapeKind::Torus => &mut self.tori.materials,
            ShapeKind::Open => &mut self.open_sides.materials,
        }
    }

    /// The directive word of a shape; `file` is this file's number.
    pub fn shape_span(&self, file: FileId, kind: ShapeKind, index: usize) -> Option<Span> {
        let starts = match kind {
            ShapeKind::Sphere => &self.spheres.starts,
            ShapeKind::Cuboid => &self.cuboids.starts,
            ShapeKind::Cylinder => &self.cylinders.starts,
            ShapeKind::Cone => &self.cones.starts,
            ShapeKind::Triangle => &self.triangles.starts,
            ShapeKind::IndexedTriangle => &self.indexed_triangles.starts,
            ShapeKind::Torus => &self.tori.starts,
            ShapeKind::Open => &self.open_sides.starts,
        };
        let start = starts.get(index)?;
        let word = match self.open_sides.shapes.get(index).filter(|_| kind == ShapeKind::Open) {
            Some(OpenSide::Cylinder(_)) if self.dialect == Dialect::Hmc => "#cylinder",
            Some(OpenSide::Cone(_)) if self.dialect == Dialect::Hmc => "#cone",
            Some(OpenSide::Cylinder(_) | OpenSide::Cone(_)) | None => kind.directive(),
        };
        Some(Span { file, start, end: start + word.len() as u64 })
    }

    /// A triangle of three shared vertices; `None` where it has no area or a number names no vertex.
    pub fn indexed_triangle(&self, corners: [u32; 3]) -> Option<Triangle> {
        let [a, b, c] = corners.map(|corner| self.vertices.get(corner as usize));
        let vertices = [a?, b?, c?];
        let [positions, normals] = [vertices.map(|v| v.position), vertices.map(|v| v.normal)];
        Triangle::new(positions, normals, vertices.map(|v| v.texcoord)).ok()
    }

    /// The corners of a triangle of either kind; `None` for other kinds, and beyond the end of the list.
    #[inline]
    pub fn corners(&self, kind: ShapeKind, index: usize) -> Option<[Vec3; 3]> {
        match kind {
            ShapeKind::Triangle => self.triangles.shapes.get(index).map(|triangle| *triangle.vertices()),
            ShapeKind::IndexedTriangle => {
                let corners = self.indexed_triangles.shapes.get(index)?;
                let [a, b, c] = corners.map(|corner| self.vertices.get(corner as usize));
                Some([a?.position, b?.position, c?.position])
            }
            ShapeKind::Sphere
            | ShapeKind::Cuboid
            | ShapeKind::Cylinder
            | ShapeKind::Cone
            | ShapeKind::Torus
            | ShapeKind::Open => None,
        }
    }

    /// The colours of a shared triangle's corners, where all have one.
    pub fn corner_colors(&self, index: usize) -> Option<[Color; 3]> {
        let corners = self.indexed_triangles.shapes.get(index)?;
        let [a, b, c] = corners.map(|corner| self.vertex_colors.get(corner as usize).copied().flatten());
        Some([a?, b?, c?])
    }

    /// One shape of a kind; `None` beyond the end of the list.
    #[inline]
    pub fn shape(&self, kind: ShapeKind, index: usize) -> Option<Shape> {
        match kind {
            ShapeKind::Sphere => self.spheres.shapes.get(index).copied().map(Shape::Sphere),
            ShapeKind::Cuboid => self.cuboids.shapes.get(index).copied().map(Shape::Cuboid),
            ShapeKind::Cylinder => self.cylinders.shapes.get(index).copied().map(Shape::Cylinder),
            ShapeKind::Cone => self.cones.shapes.get(index).copied().map(Shape::Cone),
            ShapeKind::Triangle => self.triangles.shapes.get(index).copied().map(Shape::Triangle),
            ShapeKind::Torus => self.tori.shapes.get(index).copied().map(Shape::Torus),
            ShapeKind::Open => self.open_sides.shapes.get(index).copied().map(Shape::Open),
            ShapeKind::IndexedTriangle => {
                let corners = self.indexed_triangles.shapes.get(index).copied()?;
                self.indexed_triangle(corners).map(Shape::Triangle)
            }
        }
    }

    /// The shapes of a run of this file.
    pub fn shapes(&self, kind: ShapeKind, first: u32, count: u32) -> impl Iterator<Item = Shape> {
        let first = first as usize;
        (first..first + count as usize).filter_map(move |index| self.shape(kind, index))
    }
}
