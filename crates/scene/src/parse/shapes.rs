//! The shapes.

use super::Parser;
use super::arguments;
use crate::diagnostic::Diagnostic;
use crate::model::Item;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::ShapeList;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::OpenSide;
use dotray_geometry::ShapeError;
use dotray_geometry::Sphere;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;

impl Parser<'_> {
    #[inline]
    pub(super) fn sphere(&mut self) {
        let &[_, cx, cy, cz, r, ..] = &self.values;
        let shape = Sphere::new(Vec3::new(cx, cy, cz), r);
        self.shape(shape, ShapeKind::Sphere, |scene| &mut scene.spheres);
    }

    pub(super) fn cuboid(&mut self) {
        let &[_, cx, cy, cz, lx, ly, lz, ..] = &self.values;
        let shape = Cuboid::new(Vec3::new(cx, cy, cz), Vec3::new(lx, ly, lz));
        self.shape(shape, ShapeKind::Cuboid, |scene| &mut scene.cuboids);
    }

    pub(super) fn cylinder(&mut self) {
        let &[_, cx, cy, cz, r, h, ..] = &self.values;
        let shape = Cylinder::new(Vec3::new(cx, cy, cz), r, h);
        self.shape(shape, ShapeKind::Cylinder, |scene| &mut scene.cylinders);
    }

    pub(super) fn cone(&mut self) {
        let &[_, cx, cy, cz, r, h, top, ..] = &self.values;
        let top = if self.call.count == 7 { top } else { 0.0 };
        let shape = Cone::truncated(Vec3::new(cx, cy, cz), r, top, h);
        self.shape(shape, ShapeKind::Cone, |scene| &mut scene.cones);
    }

    /// The side alone: of a cylinder, or with a second radius of a cone.
    pub(super) fn side(&mut self) {
        let &[_, cx, cy, cz, r, h, top, ..] = &self.values;
        let center = Vec3::new(cx, cy, cz);
        let shape = match self.call.count {
            7 => Cone::truncated(center, r, top, h).map(OpenSide::Cone),
            _other => Cylinder::new(center, r, h).map(OpenSide::Cylinder),
        };
        self.shape(shape, ShapeKind::Open, |scene| &mut scene.open_sides);
    }

    pub(super) fn triangle(&mut self) {
        if self.call.count == 3 {
            return self.listed_triangle();
        }
        if self.call.count == 4 {
            return self.indexed_triangle();
        }
        let &[
            _,
            ax,
            ay,
            az,
            bx,
            by,
            bz,
            cx,
            cy,
            cz,
            nax,
            nay,
            naz,
            nbx,
            nby,
            nbz,
            ncx,
            ncy,
            ncz,
            sa,
            ta,
            sb,
            tb,
            sc,
            tc,
        ] = &self.values;
        let points = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz)];
        let normals = [Vec3::new(nax, nay, naz), Vec3::new(nbx, nby, nbz), Vec3::new(ncx, ncy, ncz)];
        let texcoords = [Vec2::new(sa, ta), Vec2::new(sb, tb), Vec2::new(sc, tc)];
        let shape = Triangle::new(points, normals, texcoords);
        self.shape(shape, ShapeKind::Triangle, |scene| &mut scene.triangles);
    }

    /// Whether its vertices exist and span an area is asked at the end of the file, for they may follow.
    pub(super) fn indexed_triangle(&mut self) {
        let mut corners = [0; 3];
        for (place, corner) in (1..).zip(&mut corners) {
            let Some(number) = self.whole(place) else { return };
            let Ok(number) = u32::try_from(number) else {
                return self.unknown(place, "unknown-vertex", "vertex", "vertices");
            };
            *corner = number;
        }
        self.shape(Ok(corners), ShapeKind::IndexedTriangle, |scene| &mut scene.indexed_triangles);
    }

    /// Takes a shape into its list and into the tree; one of no extent is left out with a warning.
    #[inline]
    pub(super) fn shape<T>(
        &mut self,
        shape: Result<T, ShapeError>,
        kind: ShapeKind,
        list: impl FnOnce(&mut SceneFile) -> &mut ShapeList<T>,
    ) {
        let Some(material) = self.material_number() else { return };
        let shape = match shape {
            Ok(shape) => shape,
            Err(fault) => return self.degenerate(fault),
        };
        if self.shape_count >= self.limits.max_shapes {
            return self.too_many_shapes();
        }
        self.shape_count += 1;
        let list = list(&mut self.scene);
        // As many as shape_count at most.
        let first = list.shapes.len() as u32;
        list.shapes.push(shape);
        list.materials.push(material);
        list.starts.push(self.call.start as u64);
        match self.scene.items.last_mut() {
            Some(Item::Run { kind: last, count, .. }) if *last == kind => *count += 1,
            Some(Item::Run { .. } | Item::Open(_) | Item::Close | Item::Instance(_)) | None => {
                self.push_item(Item::Run { kind, first, count: 1 });
            }
        }
    }

    /// The first argument of a shape. Whether it names a material is asked at the end of the file.
    #[inline]
    fn material_number(&mut self) -> Option<i32> {
        let value = self.value(0);
        let number = value as i32;
        if f64::from(number) == value && number >= self.least_material() {
            return Some(number);
        }
        self.wrong_material();
        None
    }

    /// -1 where the dialect has a default material.
    #[inline]
    fn least_material(&self) -> i32 {
        if self.conventions.default_material { -1 } else { 0 }
    }

    #[cold]
    fn wrong_material(&mut self) {
        if self.whole(0).is_some() {
            self.unknown(0, "unknown-material", "material", "materials");
        }
    }

    #[cold]
    fn degenerate(&mut self, fault: ShapeError) {
        let (bytes, call, word) = (self.bytes, self.call_span(), self.call.spec.word);
        let skip = self.token_of(0);
        let edge = self.values.iter().skip(4).position(|&edge| edge <= 0.0).unwrap_or(0);
        self.sink.warn("degenerate-shape", || {
            let place = match fault {
                ShapeError::Radius => Some(4),
                ShapeError::Height => Some(5),
                ShapeError::Edge => Some(4 + edge),
                ShapeError::NotFinite | ShapeError::Area => None,
            };
            let span = place.map_or(call, |place| arguments::arguments_span(bytes, call, place + skip, 1));
            left_out(word, fault).at(span).label("is left out")
        });
    }

    #[cold]
    fn too_many_shapes(&mut self) {
        let message = format!("there are more than {} shapes", self.limits.max_shapes);
        let span = self.call_span();
        let error = Diagnostic::error("too-many-shapes", message).at(span).label("the first one too many");
        self.sink.error(error.help("`--max-shapes N` allows more"));
        // All that follows would be too many as well.
        self.stopped = true;
    }
}

pub(super) fn left_out(word: &str, fault: ShapeError) -> Diagnostic {
    Diagnostic::warning("degenerate-shape", format!("`{word}` is left out: {fault}"))
}
