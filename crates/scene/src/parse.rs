//! Tokens to the typed tree of one file, with every fault on the way.
//!
//! A directive whose arguments are all numbers is read straight into an array; only where something is wrong (or a
//! name or text is wanted) are its tokens looked at one by one.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

mod ahead;
mod arguments;
mod bumps;
mod camera;
mod count;
mod ending;
mod group;
mod hmc;
mod jhu;
mod material;
mod shapes;
mod uva;

use crate::diagnostic::Diagnostic;
use crate::diagnostic::Sink;
use crate::dialect::Conventions;
use crate::dialect::Dialect;
use crate::directive;
use crate::directive::Directive;
use crate::directive::MAX_ARGUMENTS;
use crate::directive::Spec;
use crate::lex::Lexer;
use crate::lex::Token;
use crate::lookalike;
use crate::lookalike::Lookalike;
use crate::model::Item;
use crate::model::Placed;
use crate::model::SceneFile;
use crate::span::FileId;
use crate::span::Span;
use dotray_geometry::Mat4;
use std::path::PathBuf;

/// Bounds on what a file may make the reader do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The largest file that is read.
    pub max_file_bytes: u64,
    /// How deep included files may include others.
    pub max_include_depth: usize,
    /// How many files a scene may have.
    pub max_includes: usize,
    /// How many shapes one file may have.
    pub max_shapes: u32,
    /// How deep groups may nest in one file.
    pub max_nesting: usize,
    /// How many errors are told.
    pub max_errors: usize,
    /// How many warnings of each kind are told; the rest is counted.
    pub max_warnings_of_a_kind: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: 4 << 30,
            max_include_depth: 64,
            max_includes: 4096,
            max_shapes: u32::MAX - 1,
            max_nesting: 1 << 20,
            max_errors: 20,
            max_warnings_of_a_kind: 5,
        }
    }
}

/// The number of an include's file until the loader has found it.
pub(crate) const NOT_LOADED: FileId = FileId(u32::MAX);

/// Reads one file, on as many threads as the pool has that this is called in: that changes the time and nothing else.
/// Faults go to `sink`; what could be read comes back all the same. Included files are named, not read.
pub(crate) fn parse(
    path: PathBuf,
    bytes: &[u8],
    file: FileId,
    dialect: Dialect,
    limits: &Limits,
    sink: &mut Sink,
) -> SceneFile {
    let own = Lookalike::OtherDialect(dialect.name());
    if let Some(other) = lookalike::lookalike(bytes).filter(|other| *other != own) {
        sink.error(not_a_scene(&other, dialect, file));
        return SceneFile { path, dialect, ..SceneFile::default() };
    }
    let before = sink.mark();
    let mut parser = Parser::new(path, bytes, file, dialect, limits, sink);
    parser.ahead = ahead::Ahead::new(rayon::current_num_threads(), dialect);
    parser.run();
    if !parser.stopped {
        parser.finish();
    }
    let Parser { scene, sink, recognized, .. } = parser;
    // Whatever there is to say of such a file's words, one message says it better.
    if !recognized {
        sink.rewind(before);
        let text = "this is no .ray file: it has no directive of the language";
        sink.error(Diagnostic::error("not-a-scene", text).at(Span::new(file, 0, 0)));
    }
    scene
}

fn not_a_scene(other: &Lookalike, wanted: Dialect, file: FileId) -> Diagnostic {
    let span = Span::new(file, 0, 0);
    let error = |text: String| Diagnostic::error("not-a-scene", text).at(span);
    match other {
        Lookalike::Empty => error("the file is empty: it has no directive".to_owned()),
        Lookalike::Binary => error("this is no .ray file but binary data".to_owned()),
        Lookalike::Utf16 => error("the file is UTF-16 text".to_owned()).help("save it as UTF-8"),
        Lookalike::OtherFormat(name) => {
            error(format!("this looks like {name}, which is another format than the course's .ray"))
        }
        Lookalike::OtherDialect(name) => {
            Diagnostic::error("other-dialect", format!("the file is written in the dialect `{name}`"))
                .at(span)
                .help(format!("it is to be read as `{wanted}`; `--dialect {name}` reads it as what it is"))
        }
    }
}

/// The directive at hand.
#[derive(Clone, Copy)]
struct Call {
    spec: &'static Spec,
    /// The byte of its `#`.
    start: usize,
    /// The byte after its last argument.
    end: usize,
    /// How many arguments it has.
    count: usize,
    /// Its name or text argument.
    word: Option<Token>,
    /// How many tokens stand between the word and the first argument; -1 where the first value is none of them.
    skip: i32,
}

/// How many directives of a kind stood in the file, faulty ones included, so that one fault does not shift the numbers
/// of those that follow.
#[derive(Default)]
struct Seen {
    lights: usize,
    textures: usize,
    materials: usize,
    vertices: usize,
    /// The first vertex with a colour, and whether the file's shader shows such colours.
    colored_vertex: Option<Span>,
    shows_vertex_colors: bool,
    includes: usize,
}

/// `#light_num` and its kin.
struct Hint {
    directive: Directive,
    count: f64,
    span: Span,
}

struct Parser<'a> {
    bytes: &'a [u8],
    file: FileId,
    dialect: Dialect,
    conventions: &'static Conventions,
    limits: &'a Limits,
    sink: &'a mut Sink,
    lexer: Lexer<'a>,
    scene: SceneFile,
    call: Call,
    values: [f64; MAX_ARGUMENTS],
    /// The tokens of a directive that is looked at closely; at most as many as a message may want to name.
    tokens: Vec<Token>,
    seen: Seen,
    hints: Vec<Hint>,
    /// The numbers that `#ray_file_instance` gave, and where.
    instances: Vec<(u32, Span)>,
    /// The open groups by their numbers.
    open: Vec<u32>,
    affine: jhu::Affines,
    named: hmc::Named,
    shape_count: u32,
    ahead: ahead::Ahead,
    /// Whether any directive of the language, or a word near to one, was seen.
    recognized: bool,
    /// Whether reading stopped before the end, so that nothing can be said about what is missing.
    stopped: bool,
}

impl<'a> Parser<'a> {
    fn new(
        path: PathBuf,
        bytes: &'a [u8],
        file: FileId,
        dialect: Dialect,
        limits: &'a Limits,
        sink: &'a mut Sink,
    ) -> Self {
        let spec = directive::spec(Directive::GroupEnd);
        Self {
            bytes,
            file,
            dialect,
            conventions: dialect.conventions(),
            limits,
            sink,
            lexer: Lexer::new(bytes),
            scene: SceneFile { path, dialect, ..SceneFile::default() },
            call: Call { spec, start: 0, end: 0, count: 0, word: None, skip: 0 },
            values: [0.0; MAX_ARGUMENTS],
            tokens: Vec::new(),
            seen: Seen::default(),
            hints: Vec::new(),
            instances: Vec::new(),
            open: Vec::new(),
            affine: jhu::Affines::default(),
            named: hmc::Named::default(),
            shape_count: 0,
            ahead: ahead::Ahead::new(1, dialect),
            recognized: false,
            stopped: false,
        }
    }

    fn run(&mut self) {
        while !self.stopped {
            match self.lexer.skip_blank().map(|()| self.lexer.peek()) {
                Ok(None) => return,
                Ok(Some(b'#')) => {
                    if !self.read_ahead() {
                        self.directive();
                    }
                }
                Ok(Some(_)) => self.stray_text(),
                Err(fault) => self.unterminated(fault),
            }
            self.stopped |= self.sink.is_full();
        }
    }

    #[inline]
    fn directive(&mut self) {
        let start = self.lexer.at();
        let after_word = self.lexer.word_end();
        let word = self.bytes.get(start..after_word).unwrap_or_default();
        self.lexer.go_to(after_word);
        let Some(spec) = directive::find_in(self.dialect, word) else { return self.odd_word(word, start) };
        self.recognized = true;
        self.ahead.count(spec.directive);
        self.arguments(spec, start);
    }

    /// Everything after the word: the fast path, and the close look where it does not do.
    #[inline]
    fn arguments(&mut self, spec: &'static Spec, start: usize) {
        if self.dialect == Dialect::Hmc {
            if spec.directive == Directive::RayfileEnd {
                // What follows is not read, as the course's program does not.
                return self.lexer.go_to(self.bytes.len());
            }
            if !self.flags(spec, start) {
                return self.count_faulty(spec.directive);
            }
        }
        let after_word = self.lexer.at();
        if spec.is_numeric() {
            let numbers = self.lexer.numbers(&mut self.values);
            if numbers.clean && spec.form(numbers.count).is_some() {
                self.call = Call { spec, start, end: numbers.end, count: numbers.count, word: None, skip: 0 };
                return self.apply();
            }
            self.lexer.go_to(after_word);
        }
        if self.look_closely(spec, start) {
            self.apply();
        } else {
            self.count_faulty(spec.directive);
            self.done_in_jhu(spec.directive);
        }
    }

    #[inline]
    fn apply(&mut self) {
        match self.dialect {
            Dialect::Hmc => self.apply_hmc(),
            Dialect::Slides | Dialect::Uva | Dialect::Unisa => self.apply_directive(),
            Dialect::Jhu => {
                let directive = self.call.spec.directive;
                self.apply_directive();
                self.done_in_jhu(directive);
            }
        }
    }

    fn apply_directive(&mut self) {
        match self.call.spec.directive {
            Directive::ShapeSphere => self.sphere(),
            Directive::ShapeBox => self.cuboid(),
            Directive::ShapeCylinder => self.cylinder(),
            Directive::ShapeCone => self.cone(),
            Directive::ShapeSide => self.side(),
            Directive::ShapeTriangle => self.triangle(),
            Directive::Vertex => self.vertex(),
            Directive::GroupBegin => self.group_begin(),
            Directive::GroupEnd => self.group_end(),
            Directive::Camera => self.camera(),
            Directive::Background => self.background(),
            Directive::Ambient => self.ambient(),
            Directive::LightPoint => self.light_point(),
            Directive::LightSpot => self.light_spot(),
            Directive::LightDir => self.light_directional(),
            Directive::LightArea => self.light_area(),
            Directive::Texture => self.texture(),
            Directive::Material => self.material(),
            Directive::RayFile => self.ray_file(),
            Directive::RayFileInstance => self.instance(),
            Directive::LightNum
            | Directive::TextureNum
            | Directive::MaterialNum
            | Directive::VertexNum
            | Directive::RayFileNum => self.hint(),
            Directive::JointBegin => self.joint_begin(),
            Directive::JointEnd => self.joint_end(),
            Directive::KeyFile => self.key_file(),
            Directive::Shader => self.shader(),
            Directive::StaticAffine => self.static_affine(),
            Directive::ListBegin => self.list_begin(),
            Directive::ListEnd => self.list_end(),
            Directive::Triangles => self.triangles(),
            Directive::ShapeTorus => self.torus(),
            Directive::Version | Directive::RayfileEnd => {}
            Directive::Translate => self.translate(),
            Directive::Rotate => self.rotate(),
            Directive::Scale => self.scale(),
        }
    }

    /// Keeps the numbering of what follows right when a directive could not be read.
    fn count_faulty(&mut self, directive: Directive) {
        match directive {
            Directive::LightPoint | Directive::LightSpot | Directive::LightDir | Directive::LightArea => {
                self.seen.lights += 1;
            }
            Directive::Texture => self.seen.textures += 1,
            Directive::Material => {
                self.seen.materials += 1;
                self.faulty_name();
            }
            Directive::Vertex => self.seen.vertices += 1,
            Directive::RayFile => self.seen.includes += 1,
            // A group that could not be read is still a group, or its end would be a second fault.
            Directive::GroupBegin | Directive::JointBegin => {
                self.open_group(Placed { value: Mat4::IDENTITY, span: self.call_span() });
            }
            Directive::GroupEnd | Directive::JointEnd => self.group_end(),
            Directive::StaticAffine => self.open_affine(Mat4::IDENTITY),
            Directive::ListBegin => self.list_begin(),
            Directive::ListEnd => self.list_end(),
            Directive::Camera
            | Directive::Background
            | Directive::Ambient
            | Directive::LightNum
            | Directive::TextureNum
            | Directive::MaterialNum
            | Directive::ShapeSphere
            | Directive::ShapeBox
            | Directive::ShapeCylinder
            | Directive::ShapeCone
            | Directive::ShapeSide
            | Directive::ShapeTriangle
            | Directive::VertexNum
            | Directive::RayFileNum
            | Directive::RayFileInstance
            | Directive::KeyFile
            | Directive::Shader
            | Directive::Triangles
            | Directive::ShapeTorus
            | Directive::Version
            | Directive::RayfileEnd
            | Directive::Translate
            | Directive::Rotate
            | Directive::Scale => {}
        }
    }

    /// A word that is no directive as it stands.
    #[cold]
    fn odd_word(&mut self, word: &[u8], start: usize) {
        let span = self.span(start, start + word.len());
        let mut known = directive::words_of(self.dialect);
        if let Some(spec) = known.find(|spec| spec.word.as_bytes().eq_ignore_ascii_case(word)) {
            self.recognized = true;
            let shown = arguments::shown(word);
            self.sink.warn("letter-case", || {
                Diagnostic::warning("letter-case", format!("{shown} is not written in lower case"))
                    .at(span)
                    .label(format!("read as `{}`", spec.word))
            });
            return self.arguments(spec, start);
        }
        if self.dialect == Dialect::Jhu && lookalike::is_solid_geometry(word) {
            return self.solid_geometry(word, span);
        }
        let suggestion = directive::suggest_in(self.dialect, word);
        let dialect = lookalike::foreign_directive(word).filter(|other| *other != self.dialect.name());
        self.recognized |= suggestion.is_some() || dialect.is_some();
        let error =
            Diagnostic::error("unknown-directive", format!("unknown directive {}", arguments::shown(word)));
        let error = error.at(span).label("no directive has this name");
        let read = self.dialect;
        let foreign = dialect
            .map(|dialect| format!("it belongs to the dialect `{dialect}`; the file is read as `{read}`"));
        let meant = suggestion.map(|spec| format!("did you mean `{}`?", spec.word));
        let comment = (word == b"#").then(|| "a comment begins with `//`".to_owned());
        let help: Vec<String> = [foreign, meant, comment].into_iter().flatten().collect();
        self.sink.error(Diagnostic { help: (!help.is_empty()).then(|| help.join("; ")), ..error });
        self.skip_arguments();
    }

    fn push_item(&mut self, item: Item) {
        self.scene.items.push(item);
    }

    fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start, end)
    }

    /// The directive at hand from `#` to its last argument.
    fn call_span(&self) -> Span {
        self.span(self.call.start, self.call.end)
    }
}
