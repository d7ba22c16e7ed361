// The scene as the slides' rayview shows it: the formula of shading without shadows, mirrored and refracted rays.
//
// Coordinates are those of the view's frame: the scene's centre is the origin and the scene reaches to about 1. Round
// shapes are quads on the screen whose fragments cast a ray, so their silhouettes are exact at any distance.

struct View {
    // Eye; the world's length of the view's 1.
    eye: vec4<f32>,
    // Right and the tangent of half the horizontal angle; up and that of the vertical one.
    right: vec4<f32>,
    up: vec4<f32>,
    // Ahead; the distance of the near plane.
    ahead: vec4<f32>,
    ambient: vec4<f32>,
    // The number of lights; texels in a row of the tables; where in `places` colours begin, and frames.
    counts: vec4<u32>,
    // That of the noise, four numbers a word.
    permutation: array<vec4<u32>, 16>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var materials: texture_2d<f32>;
@group(0) @binding(2) var lights: texture_2d<f32>;
@group(0) @binding(3) var pictures: texture_2d_array<f32>;
@group(0) @binding(4) var picture_sampler: sampler;
// Heights of images, four a texel; colours of corners, each with its frame's number; the rows of object_from_view,
// three a frame.
@group(0) @binding(5) var places: texture_2d<f32>;

const NEVER: f32 = 3.0e38;

// ---- from the frame to the screen: depth is near / distance, 1 at the near plane and 0 at infinity

fn in_camera(point: vec3<f32>) -> vec3<f32> {
    let p = point - view.eye.xyz;
    return vec3<f32>(dot(p, view.right.xyz), dot(p, view.up.xyz), dot(p, view.ahead.xyz));
}

fn clip(point: vec3<f32>) -> vec4<f32> {
    let p = in_camera(point);
    return vec4<f32>(p.x / view.right.w, p.y / view.up.w, view.ahead.w, p.z);
}

fn depth_at(ray: vec3<f32>, t: f32) -> f32 {
    return clamp(view.ahead.w / (t * dot(ray, view.ahead.xyz)), 0.0, 1.0);
}

// The ray through a place of the screen, 1 ahead of the eye.
fn ray_at(place: vec2<f32>) -> vec3<f32> {
    return view.ahead.xyz + view.right.xyz * (place.x * view.right.w) + view.up.xyz * (place.y * view.up.w);
}

// ---- 3-D textures and bumps: places of object space, as the renderer's noise.rs and solid.rs have them

fn permuted(i: u32) -> u32 {
    let at = i & 255u;
    let word = view.permutation[at >> 4u][(at >> 2u) & 3u];
    return (word >> ((at & 3u) * 8u)) & 255u;
}

fn gradient(hash: u32) -> vec3<f32> {
    let h = hash & 15u;
    let first = select(1.0, -1.0, (h & 1u) != 0u);
    let second = select(1.0, -1.0, (h & 2u) != 0u);
    if (h < 4u) { return vec3<f32>(first, second, 0.0); }
    if (h < 8u) { return vec3<f32>(first, 0.0, second); }
    if (h == 12u || h == 14u) { return vec3<f32>(second, first, 0.0); }
    return vec3<f32>(0.0, first, second);
}

// The gradient of the noise, and its value.
fn noise(q: vec3<f32>) -> vec4<f32> {
    let low = floor(q);
    let f = q - low;
    let cell = vec3<u32>(low - 256.0 * floor(low / 256.0));
    let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let slope = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    var sum = vec4<f32>(0.0);
    for (var i = 0u; i < 8u; i++) {
        let corner = vec3<u32>(i & 1u, (i >> 1u) & 1u, i >> 2u);
        let g = gradient(permuted(permuted(permuted(cell.x + corner.x) + cell.y + corner.y) + cell.z + corner.z));
        let c = vec3<f32>(corner);
        let value = dot(g, f - c);
        let w = mix(1.0 - u, u, c);
        let d = slope * (2.0 * c - 1.0);
        let leaning = vec3<f32>(d.x * w.y * w.z, w.x * d.y * w.z, w.x * w.y * d.z);
        let weight = w.x * w.y * w.z;
        sum += vec4<f32>(g * weight + leaning * value, weight * value);
    }
    return sum;
}

// The sums over octaves: the gradient of the plain one, and it or that of absolute values. Octaves beyond the tenth
// are finer than what single precision can place.
fn octaves_of(q: vec3<f32>, octaves: f32, absolute: bool) -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    var frequency = 1.0;
    for (var k = 0; k < i32(min(octaves, 10.0)); k++) {
        let n = noise(q * frequency);
        sum += vec4<f32>(n.xyz, select(n.w, abs(n.w), absolute) / frequency);
        frequency *= 2.0;
    }
    return sum;
}

fn weight_of(kind: f32, q: vec3<f32>, octaves: f32) -> f32 {
    if (kind == 0.0) { return clamp(0.5 + 0.5 * octaves_of(q, octaves, false).w, 0.0, 1.0); }
    if (kind == 1.0) { return 0.5 + 0.5 * sin(3.141592653589793 * (q.x + 2.0 * octaves_of(q, octaves, true).w)); }
    if (kind == 2.0) { return fract(length(q.xz) + 0.2 * octaves_of(q, octaves, false).w); }
    // Faces lie on borders of cells, within what single precision is off.
    let cells = floor(q + 1e-4);
    let sum = cells.x + cells.y + cells.z;
    return select(0.0, 1.0, sum - 2.0 * floor(sum * 0.5) == 0.0);
}

// ---- images as heights

// How texture coordinates run over a surface: as they do about the y axis of object space (0); along x on what y
// stands on (1); as a step to the right and one up on the screen tell, which change the point and (s, t) so much (2).
struct Course {
    kind: u32,
    right: vec3<f32>,
    up: vec3<f32>,
    st_right: vec2<f32>,
    st_up: vec2<f32>,
}

fn course(kind: u32) -> Course {
    return Course(kind, vec3<f32>(0.0), vec3<f32>(0.0), vec2<f32>(0.0), vec2<f32>(0.0));
}

struct Axes {
    s: vec3<f32>,
    t: vec3<f32>,
}

fn unit_or_zero(v: vec3<f32>) -> vec3<f32> {
    let size = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if (size == 0.0) { return v; }
    return normalize(v / size);
}

// The unit vectors of object space along which s and t grow fastest; 0 where they do not.
fn axes_of(how: Course, x: vec3<f32>, y: vec3<f32>, z: vec3<f32>, n: vec3<f32>) -> Axes {
    if (how.kind < 2u) {
        var s = vec3<f32>(1.0, 0.0, 0.0);
        if (how.kind == 0u || abs(n.y) < 0.5) { s = unit_or_zero(vec3<f32>(n.z, 0.0, -n.x)); }
        return Axes(s, cross(s, n));
    }
    var a = vec3<f32>(dot(x, how.right), dot(y, how.right), dot(z, how.right));
    var b = vec3<f32>(dot(x, how.up), dot(y, how.up), dot(z, how.up));
    let size = max(length(a), length(b));
    a /= size;
    b /= size;
    let across = cross(a, b);
    // What is 1 more along the one step and 0 along the other grows along these.
    let first = cross(b, across);
    let second = cross(across, a);
    let s = first * how.st_right.x + second * how.st_up.x;
    let t = first * how.st_right.y + second * how.st_up.y;
    return Axes(unit_or_zero(s), unit_or_zero(t));
}

fn height_of(first: u32, texel: u32) -> f32 {
    let four = row_of(places, first + (texel >> 2u));
    return four[texel & 3u];
}

// The height about (s, t), between the four texels there; the picture repeats.
fn height_at(first: u32, columns: u32, rows: u32, st: vec2<f32>) -> f32 {
    let size = vec2<f32>(f32(columns), f32(rows));
    let place = fract(st) * size - 0.5;
    let low = floor(place);
    let part = place - low;
    let left = select(u32(max(low.x, 0.0)), columns - 1u, low.x < 0.0);
    let up = select(u32(max(low.y, 0.0)), rows - 1u, low.y < 0.0);
    let right = select(left + 1u, 0u, left + 1u >= columns);
    let down = select(up + 1u, 0u, up + 1u >= rows);
    let upper = mix(height_of(first, up * columns + left), height_of(first, up * columns + right), part.x);
    let lower = mix(height_of(first, down * columns + left), height_of(first, down * columns + right), part.x);
    return mix(upper, lower, part.y);
}

// How much higher it is a texel to the right, and one down.
fn slopes_of(head: vec4<f32>, half: vec2<f32>, st: vec2<f32>) -> vec2<f32> {
    let first = u32(head.y);
    let columns = u32(head.z);
    let rows = u32(head.w);
    let right = vec2<f32>(half.x, 0.0);
    let down = vec2<f32>(0.0, half.y);
    return vec2<f32>(
        height_at(first, columns, rows, st + right) - height_at(first, columns, rows, st - right),
        height_at(first, columns, rows, st + down) - height_at(first, columns, rows, st - down),
    );
}

struct Carved {
    color: vec3<f32>,
    normal: vec3<f32>,
}

// The product of the colours, and the unit normal leaned by the slopes.
fn carved(first: f32, point: vec3<f32>, outward: vec3<f32>, frame: u32, st: vec2<f32>, how: Course) -> Carved {
    var result: Carved;
    result.color = vec3<f32>(1.0);
    result.normal = outward;
    if (first < 0.0) { return result; }
    let x = row_of(places, view.counts.w + frame * 3u);
    let y = row_of(places, view.counts.w + frame * 3u + 1u);
    let z = row_of(places, view.counts.w + frame * 3u + 2u);
    let h = vec4<f32>(point, 1.0);
    let p = vec3<f32>(dot(x, h), dot(y, h), dot(z, h));
    let determinant = dot(x.xyz, cross(y.xyz, z.xyz));
    let across = vec3<f32>(
        dot(cross(y.xyz, z.xyz), outward),
        dot(cross(z.xyz, x.xyz), outward),
        dot(cross(x.xyz, y.xyz), outward),
    );
    let n = unit_or_zero(across * select(1.0, -1.0, determinant < 0.0));
    var slopes = vec3<f32>(0.0);
    var at = u32(first);
    for (var more = 1.0; more > 0.0; at += 3u) {
        let head = row_of(materials, at);
        let one = row_of(materials, at + 1u);
        let two = row_of(materials, at + 2u);
        more = one.w;
        if (head.x == 5.0) {
            let axes = axes_of(how, x.xyz, y.xyz, z.xyz, n);
            let rise = slopes_of(head, one.xy, st) * two.x;
            slopes += axes.s * rise.x + axes.t * rise.y;
        } else if (head.x == 4.0) {
            slopes += octaves_of(p * head.y, head.z, false).xyz * (head.w * head.y);
        } else {
            result.color *= mix(two.rgb, one.rgb, weight_of(head.x, p * head.y, head.z));
        }
    }
    if (dot(slopes, slopes) > 0.0) {
        let leaned = n - (slopes - n * dot(slopes, n));
        result.normal = normalize(x.xyz * leaned.x + y.xyz * leaned.y + z.xyz * leaned.z);
    }
    return result;
}

// ---- shading

fn row_of(table: texture_2d<f32>, texel: u32) -> vec4<f32> {
    return textureLoad(table, vec2<u32>(texel % view.counts.y, texel / view.counts.y), 0);
}

fn power(base: f32, exponent: f32) -> f32 {
    if (exponent == 0.0) { return 1.0; }
    if (base <= 0.0) { return 0.0; }
    return pow(base, exponent);
}

fn shade(
    point: vec3<f32>,
    ray: vec3<f32>,
    outward: vec3<f32>,
    st: vec2<f32>,
    material: u32,
    frame: u32,
    how: Course,
    // The surface's own colour, and whether it has one.
    own: vec4<f32>,
) -> vec4<f32> {
    let d = normalize(ray);
    let straight = normalize(outward);
    var ambient = row_of(materials, material * 4u + 0u);
    var diffuse = row_of(materials, material * 4u + 1u);
    let specular = row_of(materials, material * 4u + 2u);
    let emissive = row_of(materials, material * 4u + 3u);
    if (own.w > 0.0) {
        ambient = vec4<f32>(own.rgb, ambient.w);
        diffuse = vec4<f32>(own.rgb, diffuse.w);
    }
    let layer = max(i32(diffuse.w), 0);
    var texel = textureSampleLevel(pictures, picture_sampler, st, layer, 0.0).rgb;
    if (diffuse.w < 0.0) { texel = vec3<f32>(1.0); }
    let carving = carved(specular.w, point, straight, frame, st, how);
    texel *= carving.color;
    var n = carving.normal;
    if (dot(straight, d) > 0.0) { n = -n; }
    var color = emissive.rgb + ambient.rgb * view.ambient.rgb * texel;
    let mirrored = reflect(d, n);
    for (var i = 0u; i < view.counts.x; i++) {
        let head = row_of(lights, i * 7u + 0u);
        let place = row_of(lights, i * 7u + 1u);
        let axis = row_of(lights, i * 7u + 2u);
        let fading = row_of(lights, i * 7u + 3u);
        var towards = -axis.xyz;
        var strength = 1.0;
        if (head.w != 2.0) {
            let offset = place.xyz - point;
            let distance = length(offset);
            towards = offset / max(distance, 1e-20);
            let far = distance * view.eye.w;
            let sum = fading.x + fading.y * far + fading.z * far * far;
            if (sum > 0.0) { strength = 1.0 / sum; }
            let cosine = -dot(towards, axis.xyz);
            if (head.w == 1.0) {
                if (cosine < place.w) { strength = 0.0; } else { strength *= power(max(cosine, 0.0), axis.w); }
            }
            if (head.w == 3.0 && cosine <= 0.0) { strength = 0.0; }
        }
        let tint = row_of(lights, i * 7u + 4u).rgb;
        if (strength > 0.0) { color += head.rgb * strength * ambient.rgb * tint * texel; }
        let facing = dot(n, towards);
        if (facing > 0.0 && strength > 0.0) {
            let highlight = power(max(dot(mirrored, towards), 0.0), ambient.w);
            let scattered = diffuse.rgb * texel * facing * row_of(lights, i * 7u + 5u).rgb;
            color += head.rgb * strength * (scattered + specular.rgb * highlight * row_of(lights, i * 7u + 6u).rgb);
        }
    }
    if (emissive.w > 0.0) { color *= texel; }
    return vec4<f32>(clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)), 1.0);
}

// Texture coordinates around the y axis; the seam is at -z.
fn around(p: vec3<f32>) -> f32 {
    return atan2(p.x, p.z) / 6.283185307179586 + 0.5;
}

struct Fragment {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

fn corner_of(vertex: u32, low: vec2<f32>, high: vec2<f32>) -> vec2<f32> {
    let a = vec2<f32>(f32(vertex & 1u), f32(vertex >> 1u));
    return clamp(mix(low, high, a), vec2<f32>(-1.0), vec2<f32>(1.0));
}

const NO_COLOR: vec4<f32> = vec4<f32>(0.0);

const NOWHERE: vec4<f32> = vec4<f32>(2.0, 2.0, 0.5, 1.0);

// ---- spheres

struct Ball {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
    @location(1) @interpolate(flat, either) center: vec4<f32>,
    @location(2) @interpolate(flat, either) material: u32,
}

// Where the silhouette ends along one axis of the screen: the two tangents from the eye to a circle.
fn tangents(across: f32, ahead: f32, r: f32) -> vec2<f32> {
    let square = sqrt(max(across * across + ahead * ahead - r * r, 0.0));
    return vec2<f32>(across * ahead - r * square, across * ahead + r * square) / (ahead * ahead - r * r);
}

@vertex
fn ball_vertex(@builtin(vertex_index) vertex: u32, @location(0) ball: vec4<f32>, @location(1) material: u32) -> Ball {
    let c = in_camera(ball.xyz);
    let r = ball.w;
    var low = vec2<f32>(-1.0);
    var high = vec2<f32>(1.0);
    if (c.z > r * 1.0001) {
        // A little more than the exact silhouette, for the sake of rounding.
        let x = tangents(c.x, c.z, r * 1.0001) / view.right.w;
        let y = tangents(c.y, c.z, r * 1.0001) / view.up.w;
        low = vec2<f32>(x.x, y.x);
        high = vec2<f32>(x.y, y.y);
    }
    var out: Ball;
    out.place = corner_of(vertex, low, high);
    out.position = vec4<f32>(out.place, 0.5, 1.0);
    if (c.z < -r) { out.position = NOWHERE; }
    out.center = vec4<f32>(ball.xyz - view.eye.xyz, r);
    out.material = material;
    return out;
}

@fragment
fn ball_fragment(in: Ball) -> Fragment {
    let ray = ray_at(in.place);
    let square = dot(ray, ray);
    let middle = dot(ray, in.center.xyz) / square;
    let nearest = in.center.xyz - ray * middle;
    let depth = in.center.w * in.center.w - dot(nearest, nearest);
    if (depth < 0.0) { discard; }
    let half = sqrt(depth / square);
    var t = middle - half;
    if (t < view.ahead.w) { t = middle + half; }
    if (t < view.ahead.w) { discard; }
    let from_eye = ray * t;
    var out: Fragment;
    let outward = from_eye - in.center.xyz;
    out.color = shade(view.eye.xyz + from_eye, ray, outward, vec2<f32>(0.0), in.material, 0u, course(0u), NO_COLOR);
    out.depth = depth_at(ray, t);
    return out;
}

// ---- other round shapes: images of unit shapes

struct Solid {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
    // The rows of unit_from_view; their fourth numbers are the eye in the unit shape's coordinates.
    @location(1) @interpolate(flat, either) x: vec4<f32>,
    @location(2) @interpolate(flat, either) y: vec4<f32>,
    @location(3) @interpolate(flat, either) z: vec4<f32>,
    // Its material, unit shape and frame.
    @location(4) @interpolate(flat, either) which: vec3<u32>,
    // Below and above.
    @location(5) @interpolate(flat, either) radii: vec2<f32>,
}

@vertex
fn solid_vertex(
    @builtin(vertex_index) vertex: u32,
    @location(0) x: vec4<f32>,
    @location(1) y: vec4<f32>,
    @location(2) z: vec4<f32>,
    @location(3) material: u32,
    @location(4) unit: u32,
    @location(5) radii: vec2<f32>,
    @location(6) frame: u32,
) -> Solid {
    var low = vec2<f32>(1.0);
    var high = vec2<f32>(-1.0);
    var behind = 0;
    for (var i = 0u; i < 8u; i++) {
        let u = vec4<f32>(vec3<f32>(f32(i & 1u), f32((i >> 1u) & 1u), f32(i >> 2u)) * 2.0 - 1.0, 1.0);
        let c = in_camera(vec3<f32>(dot(x, u), dot(y, u), dot(z, u)));
        if (c.z < view.ahead.w) {
            behind += 1;
        } else {
            let p = c.xy / (c.z * vec2<f32>(view.right.w, view.up.w));
            low = min(low, p);
            high = max(high, p);
        }
    }
    if (behind > 0) {
        low = vec2<f32>(-1.0);
        high = vec2<f32>(1.0);
    }
    // The inverse from the cross products of the columns.
    let a = vec3<f32>(x.x, y.x, z.x);
    let b = vec3<f32>(x.y, y.y, z.y);
    let c = vec3<f32>(x.z, y.z, z.z);
    let determinant = dot(a, cross(b, c));
    let rx = cross(b, c) / determinant;
    let ry = cross(c, a) / determinant;
    let rz = cross(a, b) / determinant;
    let eye = view.eye.xyz - vec3<f32>(x.w, y.w, z.w);
    var out: Solid;
    out.place = corner_of(vertex, low - 1e-5, high + 1e-5);
    out.position = vec4<f32>(out.place, 0.5, 1.0);
    if (behind == 8) { out.position = NOWHERE; }
    out.x = vec4<f32>(rx, dot(rx, eye));
    out.y = vec4<f32>(ry, dot(ry, eye));
    out.z = vec4<f32>(rz, dot(rz, eye));
    out.which = vec3<u32>(material, unit, frame);
    out.radii = radii;
    return out;
}

// What a ray meets first: t, the unit shape's normal, and its face (0 side, 1 top, 2 bottom).
struct Meeting {
    t: f32,
    face: u32,
}

fn nearer(best: Meeting, t: f32, low: f32, counts: bool, face: u32) -> Meeting {
    var next = best;
    if (counts && t > low && t < best.t) {
        next.t = t;
        next.face = face;
    }
    return next;
}

// Units: 0 is a sphere, 1 is round about y with discs, 2 without.
fn meet(o: vec3<f32>, d: vec3<f32>, low: f32, unit: u32, radii: vec2<f32>) -> Meeting {
    var best = Meeting(NEVER, 0u);
    // The radius at the ray's place t is e.x + e.y t.
    let slope = (radii.y - radii.x) * 0.5;
    var e = vec2<f32>((radii.x + radii.y) * 0.5 + slope * o.y, slope * d.y);
    if (unit == 0u) { e = vec2<f32>(1.0, 0.0); }
    var a = dot(d.xz, d.xz) - e.y * e.y;
    var b = dot(o.xz, d.xz) - e.x * e.y;
    var c = dot(o.xz, o.xz) - e.x * e.x;
    if (unit == 0u) {
        a += d.y * d.y;
        b += o.y * d.y;
        c += o.y * o.y;
    }
    let root = b * b - a * c;
    if (root >= 0.0) {
        // Both roots without cancellation; where the radius is below 0, y is beyond -1 to 1.
        let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(root));
        let t0 = q / a;
        let t1 = c / q;
        best = nearer(best, t0, low, unit == 0u || abs(o.y + d.y * t0) <= 1.0, 0u);
        best = nearer(best, t1, low, unit == 0u || abs(o.y + d.y * t1) <= 1.0, 0u);
    }
    if (unit == 1u) {
        let bottom = (-1.0 - o.y) / d.y;
        let below = o.xz + d.xz * bottom;
        best = nearer(best, bottom, low, dot(below, below) <= radii.x * radii.x, 2u);
        let top = (1.0 - o.y) / d.y;
        let above = o.xz + d.xz * top;
        best = nearer(best, top, low, radii.y > 0.0 && dot(above, above) <= radii.y * radii.y, 1u);
    }
    return best;
}

fn unit_normal(p: vec3<f32>, unit: u32, face: u32, radii: vec2<f32>) -> vec3<f32> {
    if (face == 1u) { return vec3<f32>(0.0, 1.0, 0.0); }
    if (face == 2u) { return vec3<f32>(0.0, -1.0, 0.0); }
    if (unit == 0u) { return p; }
    let slope = (radii.y - radii.x) * 0.5;
    return vec3<f32>(p.x, -slope * ((radii.x + radii.y) * 0.5 + slope * p.y), p.z);
}

fn unit_texture(p: vec3<f32>, unit: u32, face: u32, radii: vec2<f32>) -> vec2<f32> {
    if (face == 1u) { return vec2<f32>(p.x + radii.y, p.z + radii.y) * (0.5 / radii.y); }
    if (face == 2u) { return vec2<f32>(p.x + radii.x, radii.x - p.z) * (0.5 / radii.x); }
    if (unit == 0u) { return vec2<f32>(around(p), acos(clamp(p.y, -1.0, 1.0)) / 3.141592653589793); }
    return vec2<f32>(around(p), (1.0 - p.y) * 0.5);
}

@fragment
fn solid_fragment(in: Solid) -> Fragment {
    let ray = ray_at(in.place);
    let d = vec3<f32>(dot(in.x.xyz, ray), dot(in.y.xyz, ray), dot(in.z.xyz, ray));
    let eye = vec3<f32>(in.x.w, in.y.w, in.z.w);
    // From the place nearest to the shape's centre, lest small shapes far away drown in rounding.
    let ahead = -dot(eye, d) / dot(d, d);
    let o = eye + d * ahead;
    let met = meet(o, d, view.ahead.w - ahead, in.which.y, in.radii);
    if (met.t == NEVER) { discard; }
    let p = o + d * met.t;
    let n = unit_normal(p, in.which.y, met.face, in.radii);
    let normal = in.x.xyz * n.x + in.y.xyz * n.y + in.z.xyz * n.z;
    let t = met.t + ahead;
    var out: Fragment;
    let st = unit_texture(p, in.which.y, met.face, in.radii);
    let how = course(select(1u, 0u, met.face == 0u));
    out.color = shade(view.eye.xyz + ray * t, ray, normal, st, in.which.x, in.which.z, how, NO_COLOR);
    out.depth = depth_at(ray, t);
    return out;
}

// ---- boxes: the three faces towards the eye, or all far ones from inside

struct Surface {
    @builtin(position) position: vec4<f32>,
    @location(0) point: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) st: vec2<f32>,
    @location(3) @interpolate(flat, either) material: u32,
    @location(4) @interpolate(flat, either) frame: u32,
    // Its own colour, and whether it has one.
    @location(5) own: vec4<f32>,
}

fn box_texture(u: vec3<f32>, axis: u32, positive: bool) -> vec2<f32> {
    let s = select(-1.0, 1.0, positive);
    if (axis == 0u) { return vec2<f32>(-s * u.z, -u.y) * 0.5 + 0.5; }
    if (axis == 1u) { return vec2<f32>(u.x, s * u.z) * 0.5 + 0.5; }
    return vec2<f32>(s * u.x, -u.y) * 0.5 + 0.5;
}

@vertex
fn box_vertex(
    @builtin(vertex_index) vertex: u32,
    @location(0) x: vec4<f32>,
    @location(1) y: vec4<f32>,
    @location(2) z: vec4<f32>,
    @location(3) material: u32,
    @location(6) frame: u32,
) -> Surface {
    let a = vec3<f32>(x.x, y.x, z.x);
    let b = vec3<f32>(x.y, y.y, z.y);
    let c = vec3<f32>(x.z, y.z, z.z);
    let mirrored = select(1.0, -1.0, dot(a, cross(b, c)) < 0.0);
    let normals = mat3x3<f32>(cross(b, c) * mirrored, cross(c, a) * mirrored, cross(a, b) * mirrored);
    let eye = view.eye.xyz - vec3<f32>(x.w, y.w, z.w);
    // How far the eye is out, in the unit box's coordinates.
    let size = max(abs(dot(a, cross(b, c))), 1e-37);
    let out_by = vec3<f32>(dot(normals[0], eye), dot(normals[1], eye), dot(normals[2], eye)) / size;
    let inside = all(abs(out_by) < vec3<f32>(1.0));
    let axis = vertex / 6u;
    let toward = select(out_by.z, select(out_by.y, out_by.x, axis == 0u), axis < 2u) >= 0.0;
    let positive = toward != inside;
    let sign = select(-1.0, 1.0, positive);
    let step = vertex % 6u;
    // Two triangles: 0 1 2, 2 1 3.
    let corner = select(step, select(1u, 3u, step == 5u), step > 3u);
    let at = select(corner, 2u, step == 3u);
    let p = f32(at & 1u) * 2.0 - 1.0;
    let q = f32(at >> 1u) * 2.0 - 1.0;
    var u = vec3<f32>(sign, p, q);
    var normal = normals[0];
    if (axis == 1u) {
        u = vec3<f32>(p, sign, q);
        normal = normals[1];
    }
    if (axis == 2u) {
        u = vec3<f32>(p, q, sign);
        normal = normals[2];
    }
    let h = vec4<f32>(u, 1.0);
    var out: Surface;
    out.point = vec3<f32>(dot(x, h), dot(y, h), dot(z, h));
    out.position = clip(out.point);
    out.normal = normalize(normal) * sign;
    out.st = box_texture(u, axis, positive);
    out.material = material;
    out.frame = frame;
    out.own = NO_COLOR;
    return out;
}

// ---- triangles

// From here on a frame's number is that of a colour, which has the frame's.
const COLORED: u32 = 0x80000000u;

@vertex
fn corner_vertex(
    @location(0) point: vec3<f32>,
    @location(1) folded: vec2<f32>,
    @location(2) st: vec2<f32>,
    @location(3) material: u32,
    @location(6) frame: u32,
) -> Surface {
    let z = 1.0 - abs(folded.x) - abs(folded.y);
    let fold = max(-z, 0.0);
    let xy = folded - select(vec2<f32>(-fold), vec2<f32>(fold), folded >= vec2<f32>(0.0));
    var out: Surface;
    out.point = point;
    out.position = clip(point);
    out.normal = vec3<f32>(xy, z);
    out.st = st;
    out.material = material;
    out.frame = frame;
    out.own = NO_COLOR;
    if (frame >= COLORED) {
        let color = row_of(places, view.counts.z + frame - COLORED);
        out.own = vec4<f32>(color.rgb, 1.0);
        out.frame = u32(color.w);
    }
    return out;
}

@fragment
fn surface_fragment(in: Surface) -> @location(0) vec4<f32> {
    let how = Course(2u, dpdx(in.point), dpdy(in.point), dpdx(in.st), dpdy(in.st));
    return shade(in.point, in.point - view.eye.xyz, in.normal, in.st, in.material, in.frame, how, in.own);
}

// ---- lines

struct Line {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec4<f32>,
}

@vertex
fn line_vertex(@location(0) point: vec3<f32>, @location(1) color: vec4<f32>) -> Line {
    var out: Line;
    out.position = clip(point);
    out.color = color;
    return out;
}

@fragment
fn line_fragment(in: Line) -> @location(0) vec4<f32> {
    return vec4<f32>(in.color.rgb * in.color.a, in.color.a);
}

@fragment
fn faint_fragment(in: Line) -> @location(0) vec4<f32> {
    return vec4<f32>(in.color.rgb, 1.0) * (in.color.a * 0.3);
}
