//! The conversation: what the editor says, and what it is answered.

use crate::check::Checked;
use crate::check::Reading;
use crate::check::check;
use crate::complete::complete;
use crate::documents::Document;
use crate::documents::Documents;
use crate::documents::Overlay;
use crate::hover::hover;
use crate::hover::signatures;
use crate::layout::layout;
use crate::paths::path_of;
use crate::refer::Named;
use crate::refer::existing;
use crate::refer::named;
use crate::refer::target;
use crate::spot::Spot;
use crate::symbols::colors;
use crate::symbols::links;
use crate::symbols::symbols;
use crate::text::Text;
use dotray_scene::Dialect;
use lsp_server::Connection;
use lsp_server::ErrorCode;
use lsp_server::Message;
use lsp_server::Notification;
use lsp_server::Request;
use lsp_server::Response;
use lsp_types::notification::Notification as _;
use lsp_types::request::Request as _;
use lsp_types::*;
use serde_json::Value;
use serde_json::json;
use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::panic::AssertUnwindSafe;
use std::panic::catch_unwind;
use std::time::Duration;
use std::time::Instant;

/// Why the conversation ended otherwise than it should.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The editor speaks another protocol.
    #[error("the editor does not keep to the protocol: {0}")]
    Protocol(#[from] lsp_server::ProtocolError),
    /// Standard input or output fails.
    #[error("the editor cannot be heard or reached: {0}")]
    Io(#[from] std::io::Error),
    /// The editor went without saying so.
    #[error("the editor has gone without `shutdown`")]
    Gone,
    /// Nobody reads what is said.
    #[error("the editor does not listen any more")]
    Unheard,
}

/// After a change the text is looked at when nothing more comes for so long, but at the latest after [`PATIENCE`].
const QUIET: Duration = Duration::from_millis(150);
const PATIENCE: Duration = Duration::from_millis(1500);

/// Serves one editor over standard input and output until it says goodbye.
///
/// # Errors
/// What the editor did instead of saying goodbye.
pub fn serve(dialect: Option<Dialect>) -> Result<(), ServeError> {
    let (connection, threads) = Connection::stdio();
    let ended = converse(&connection, dialect);
    drop(connection);
    // A thread that reads ends only where nothing more can come.
    let has_ended = match &ended {
        Ok(()) | Err(ServeError::Gone) => true,
        Err(ServeError::Protocol(error)) => error.channel_is_disconnected(),
        Err(ServeError::Io(_) | ServeError::Unheard) => false,
    };
    match has_ended.then(|| threads.join()) {
        // The threads know why the editor cannot be heard.
        Some(Err(error)) => Err(ServeError::Io(error)),
        Some(Ok(())) | None => ended,
    }
}

/// Serves the editor at the other end of a connection.
///
/// # Errors
/// What the editor did instead of saying goodbye.
pub fn converse(connection: &Connection, dialect: Option<Dialect>) -> Result<(), ServeError> {
    let (id, params) = connection.initialize_start()?;
    let params: InitializeParams = serde_json::from_value(params).unwrap_or_default();
    let info = json!({ "name": "dotray", "version": env!("CARGO_PKG_VERSION") });
    connection.initialize_finish(id, json!({ "capabilities": capabilities(), "serverInfo": info }))?;
    let mut server = Server::new(&params, dialect);
    let say = |messages: Vec<Message>| {
        messages
            .into_iter()
            .try_for_each(|message| connection.sender.send(message))
            .map_err(|_| ServeError::Unheard)
    };
    loop {
        let message = match server.waits_until() {
            Some(until) => match connection.receiver.recv_deadline(until) {
                Err(error) if error.is_timeout() => {
                    say(server.check_stale())?;
                    continue;
                }
                Err(_) => return Err(ServeError::Gone),
                Ok(message) => message,
            },
            None => connection.receiver.recv().map_err(|_| ServeError::Gone)?,
        };
        match message {
            Message::Notification(note) if note.method == notification::Exit::METHOD => {
                return if server.is_shut_down { Ok(()) } else { Err(ServeError::Gone) };
            }
            Message::Notification(note) => server.take(note),
            Message::Request(request) => say(server.answer(request))?,
            Message::Response(_) => {}
        }
    }
}

/// What the server can do.
fn capabilities() -> ServerCapabilities {
    let signs = |signs: &[&str]| Some(signs.iter().map(|sign| (*sign).to_owned()).collect());
    let sync = TextDocumentSyncOptions {
        open_close: Some(true),
        change: Some(TextDocumentSyncKind::INCREMENTAL),
        ..TextDocumentSyncOptions::default()
    };
    ServerCapabilities {
        position_encoding: Some(PositionEncodingKind::UTF16),
        text_document_sync: Some(TextDocumentSyncCapability::Options(sync)),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        completion_provider: Some(CompletionOptions {
            trigger_characters: signs(&["#", "!", ";", "/", "\""]),
            ..CompletionOptions::default()
        }),
        signature_help_provider: Some(SignatureHelpOptions {
            trigger_characters: signs(&[" "]),
            ..SignatureHelpOptions::default()
        }),
        definition_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        document_link_provider: Some(DocumentLinkOptions {
            resolve_provider: Some(false),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        }),
        color_provider: Some(ColorProviderCapability::Simple(true)),
        code_action_provider: Some(CodeActionProviderCapability::Options(CodeActionOptions {
            code_action_kinds: Some(vec![CodeActionKind::QUICKFIX]),
            ..CodeActionOptions::default()
        })),
        ..ServerCapabilities::default()
    }
}

/// What is known between two messages.
struct Server {
    documents: Documents,
    checked: BTreeMap<String, Checked>,
    /// The messages that the editor shows now, by files.
    published: BTreeMap<String, Vec<Diagnostic>>,
    reading: Reading,
    /// Whether the editor knows snippets.
    snippets: bool,
    /// When the first and the last change came that nobody has looked at.
    changed: Option<(Instant, Instant)>,
    is_shut_down: bool,
}

impl Server {
    fn new(params: &InitializeParams, dialect: Option<Dialect>) -> Self {
        let item = params.capabilities.text_document.as_ref();
        let item = item.and_then(|all| all.completion.as_ref()?.completion_item.as_ref());
        let options = params.initialization_options.as_ref();
        let wished = options.and_then(|options| options.get("dialect")?.as_str()).and_then(Dialect::of_name);
        let folders = params.workspace_folders.as_deref().unwrap_or_default();
        #[allow(deprecated, reason = "older editors name one folder")]
        let root = folders.first().map(|folder| &folder.uri).or(params.root_uri.as_ref());
        Self {
            documents: Documents::new(),
            checked: BTreeMap::new(),
            published: BTreeMap::new(),
            reading: Reading { dialect: wished.or(dialect), folder: root.map(path_of) },
            snippets: item.and_then(|item| item.snippet_support).unwrap_or(false),
            changed: None,
            is_shut_down: false,
        }
    }

    /// When to look at what has changed; `None` where nothing has.
    fn waits_until(&self) -> Option<Instant> {
        self.changed.map(|(first, last)| (first + PATIENCE).min(last + QUIET))
    }

    fn has_changed(&mut self) {
        let now = Instant::now();
        self.changed = Some((self.changed.map_or(now, |(first, _)| first), now));
    }

    /// Takes over what the editor tells.
    fn take(&mut self, note: Notification) {
        match note.method.as_str() {
            notification::DidOpenTextDocument::METHOD => {
                let Some(told) = read::<DidOpenTextDocumentParams>(note.params) else { return };
                let TextDocumentItem { uri, version, text, .. } = told.text_document;
                let mut document = Document::new(uri, version, text);
                document.dialect = self.reading.dialect.unwrap_or_default();
                self.spoil(&document.identity);
                self.documents.insert(document.uri.as_str().to_owned(), document);
            }
            notification::DidChangeTextDocument::METHOD => {
                let Some(told) = read::<DidChangeTextDocumentParams>(note.params) else { return };
                let key = told.text_document.uri.as_str();
                let Some(document) = self.documents.get_mut(key) else { return };
                document.change(told.text_document.version, told.content_changes);
                let identity = document.identity.clone();
                self.spoil(&identity);
            }
            notification::DidCloseTextDocument::METHOD => {
                let Some(told) = read::<DidCloseTextDocumentParams>(note.params) else { return };
                let key = told.text_document.uri.as_str();
                self.checked.remove(key);
                if let Some(document) = self.documents.remove(key) {
                    self.spoil(&document.identity);
                }
            }
            // A file on disk may be another one now: an image, an included scene.
            notification::DidSaveTextDocument::METHOD | notification::DidChangeWatchedFiles::METHOD => {
                self.documents.values_mut().for_each(|document| document.stale = true);
                self.has_changed();
            }
            _ => {}
        }
    }

    /// The texts that include this file must be looked at again.
    fn spoil(&mut self, identity: &std::path::Path) {
        for (key, checked) in &self.checked {
            if checked.includes.iter().any(|path| path == identity)
                && let Some(document) = self.documents.get_mut(key)
            {
                document.stale = true;
            }
        }
        self.has_changed();
    }

    /// Looks at all that has changed, and tells what is new.
    fn check_stale(&mut self) -> Vec<Message> {
        self.changed = None;
        let looked_at: Vec<String> = self
            .documents
            .iter()
            .filter(|(_, document)| document.stale)
            .map(|(key, _)| key.clone())
            .collect();
        let mut told = Vec::new();
        for key in looked_at.clone() {
            let Some(document) = self.documents.get(&key) else { continue };
            let looked = catch_unwind(AssertUnwindSafe(|| check(document, &self.documents, &self.reading)));
            let Some(document) = self.documents.get_mut(&key) else { continue };
            document.stale = false;
            match looked {
                Ok(checked) => {
                    document.dialect = checked.dialect;
                    self.checked.insert(key, checked);
                }
                Err(_) => told.push(log(MessageType::ERROR, format!("looking at {key} failed"))),
            }
        }
        told.extend(self.publish(&looked_at));
        told
    }

    /// What is new among the messages, file by file; of those just looked at, also what is as before.
    fn publish(&mut self, looked_at: &[String]) -> Vec<Message> {
        let mut all: BTreeMap<String, Vec<Diagnostic>> =
            self.documents.keys().map(|key| (key.clone(), Vec::new())).collect();
        for (key, checked) in &self.checked {
            let own = self.documents.get(key).map(|document| document.identity.as_path());
            let includes = || self.checked.values().flat_map(|checked| &checked.includes);
            let is_part = own.is_some_and(|own| includes().any(|path| path == own));
            for finding in &checked.findings {
                // A part that others include needs neither camera nor lamps.
                if is_part && ["no-camera", "no-light"].contains(&finding.code) {
                    continue;
                }
                let list = all.entry(finding.uri.as_str().to_owned()).or_default();
                // Seen from an including file, the same message has further notes.
                if !list.iter().any(|told| is_same(told, &finding.diagnostic)) {
                    list.push(finding.diagnostic.clone());
                }
            }
        }
        let keys: BTreeSet<String> = all.keys().chain(self.published.keys()).cloned().collect();
        let mut told = Vec::new();
        for key in keys {
            let list = all.get(&key).cloned().unwrap_or_default();
            if !looked_at.contains(&key) && self.published.get(&key).is_some_and(|before| *before == list) {
                continue;
            }
            if let Ok(uri) = key.parse() {
                let version = self.documents.get(&key).map(|document| document.version);
                let params = PublishDiagnosticsParams::new(uri, list, version);
                told.push(
                    Notification::new(notification::PublishDiagnostics::METHOD.to_owned(), params).into(),
                );
            }
        }
        all.retain(|key, list| !list.is_empty() || self.documents.contains_key(key));
        self.published = all;
        told
    }

    /// The answer to a question; with it, what the editor may show besides.
    fn answer(&mut self, request: Request) -> Vec<Message> {
        let id = request.id.clone();
        let error =
            |code: ErrorCode, message: String| Response::new_err(id.clone(), code as i32, message).into();
        if self.is_shut_down {
            return vec![error(ErrorCode::InvalidRequest, "the server is shut down".to_owned())];
        }
        if request.method == request::Shutdown::METHOD {
            self.is_shut_down = true;
            return vec![Response::new_ok(id, Value::Null).into()];
        }
        let mut told = Vec::new();
        if request.method == request::CodeActionRequest::METHOD && self.changed.is_some() {
            // Repairs of an older text would hit the wrong words.
            told = self.check_stale();
        }
        let method = request.method.clone();
        match catch_unwind(AssertUnwindSafe(|| self.result(&request))) {
            Ok(Some(Ok(result))) => told.push(Response::new_ok(id, result).into()),
            Ok(Some(Err(Refusal::Params))) => {
                told.push(error(ErrorCode::InvalidParams, format!("{method}: parameters not understood")));
            }
            Ok(Some(Err(Refusal::Said(why)))) => {
                told.push(log(MessageType::WARNING, why));
                told.push(Response::new_ok(id, Value::Null).into());
            }
            Ok(None) => told.push(error(ErrorCode::MethodNotFound, format!("{method} is not known"))),
            Err(_) => told.push(error(ErrorCode::InternalError, format!("{method} failed"))),
        }
        told
    }

    /// The result of a request; `None` where nothing is known of its method.
    fn result(&self, request: &Request) -> Option<Result<Value, Refusal>> {
        let params = || request.params.clone();
        let at = || {
            let place = read::<TextDocumentPositionParams>(params()).ok_or(Refusal::Params)?;
            Ok((self.documents.get(place.text_document.uri.as_str()), place.position))
        };
        let document = || {
            let uri =
                params().get("textDocument").and_then(|named| Some(named.get("uri")?.as_str()?.to_owned()));
            Ok(self.documents.get(&uri.ok_or(Refusal::Params)?))
        };
        let result: Result<Value, Refusal> = match request.method.as_str() {
            request::HoverRequest::METHOD => {
                at().map(|(document, at)| json!(document.and_then(|d| hover(d, at))))
            }
            request::SignatureHelpRequest::METHOD => {
                at().map(|(document, at)| json!(document.and_then(|d| signatures(d, at))))
            }
            request::Completion::METHOD => {
                at().map(|(document, at)| json!(document.map(|d| complete(d, at, self.snippets))))
            }
            request::GotoDefinition::METHOD => {
                at().map(|(document, at)| json!(document.and_then(|d| self.definition(d, at))))
            }
            request::DocumentSymbolRequest::METHOD => document().map(|document| json!(document.map(symbols))),
            request::Formatting::METHOD => document().and_then(|document| {
                document.map(layout).transpose().map(|edits| json!(edits)).map_err(Refusal::Said)
            }),
            request::DocumentLinkRequest::METHOD => {
                document().map(|document| json!(document.map(|d| self.links(d))))
            }
            request::DocumentColor::METHOD => document().map(|document| json!(document.map(color_places))),
            request::ColorPresentationRequest::METHOD => read::<ColorPresentationParams>(params())
                .map(|asked| json!(written(&asked)))
                .ok_or(Refusal::Params),
            request::CodeActionRequest::METHOD => read::<CodeActionParams>(params())
                .map(|asked| json!(self.repairs(&asked)))
                .ok_or(Refusal::Params),
            _ => return None,
        };
        Some(result)
    }

    /// Where that is declared which the word at a place names.
    fn definition(&self, document: &Document, position: Position) -> Option<Location> {
        if document.is_too_large() {
            return None;
        }
        let Document { bytes, path, dialect, uri, .. } = document;
        let text = Text::new(bytes);
        let spot = Spot::new(bytes, text.offset(position));
        match named(bytes, path, *dialect, &spot)? {
            Named::File(places) => {
                let uri = Overlay(&self.documents).uri(existing(&places)?)?;
                Some(Location::new(uri, Range::default()))
            }
            other @ (Named::Number(..) | Named::Material(_)) => {
                let found = target(bytes, *dialect, &other)?;
                Some(Location::new(uri.clone(), text.range(found.word.start, found.end)))
            }
        }
    }

    fn links(&self, document: &Document) -> Vec<DocumentLink> {
        let overlay = Overlay(&self.documents);
        let links = links(document).into_iter().filter_map(|(range, path)| {
            Some(DocumentLink { range, target: Some(overlay.uri(&path)?), tooltip: None, data: None })
        });
        links.collect()
    }

    /// The repairs of the faults in a range.
    fn repairs(&self, asked: &CodeActionParams) -> Vec<CodeActionOrCommand> {
        let uri = &asked.text_document.uri;
        let touches = |range: Range| range.start <= asked.range.end && asked.range.start <= range.end;
        let findings = self.checked.values().flat_map(|checked| &checked.findings);
        let here = findings.filter(|finding| finding.uri == *uri && touches(finding.diagnostic.range));
        let mut actions: Vec<CodeActionOrCommand> = Vec::new();
        for finding in here {
            let Some((title, edit)) = finding.repair.clone() else { continue };
            #[allow(clippy::mutable_key_type, reason = "the protocol's own type has addresses for keys")]
            let changes = std::collections::HashMap::from([(uri.clone(), vec![edit])]);
            let action = CodeActionOrCommand::CodeAction(CodeAction {
                title,
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![finding.diagnostic.clone()]),
                edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
                is_preferred: Some(true),
                ..CodeAction::default()
            });
            if !actions.contains(&action) {
                actions.push(action);
            }
        }
        actions
    }
}

/// Why a request has no result.
enum Refusal {
    /// Its parameters are not those of the protocol.
    Params,
    /// For a reason that people should read.
    Said(String),
}

fn read<P: serde::de::DeserializeOwned>(params: Value) -> Option<P> {
    serde_json::from_value(params).ok()
}

/// Whether two messages say the same in their first sentence.
fn is_same(one: &Diagnostic, other: &Diagnostic) -> bool {
    one.range == other.range
        && one.code == other.code
        && one.message.lines().next() == other.message.lines().next()
}

fn log(typ: MessageType, message: String) -> Message {
    let params = LogMessageParams { typ, message };
    Notification::new(notification::LogMessage::METHOD.to_owned(), params).into()
}

fn color_places(document: &Document) -> Vec<ColorInformation> {
    let shown = |value: f64| value.clamp(0.0, 1.0) as f32;
    let colors = colors(document).into_iter().map(|(range, [red, green, blue])| {
        let color = Color { red: shown(red), green: shown(green), blue: shown(blue), alpha: 1.0 };
        ColorInformation { range, color }
    });
    colors.collect()
}

/// A chosen colour as it is written in a scene.
fn written(asked: &ColorPresentationParams) -> Vec<ColorPresentation> {
    let Color { red, green, blue, .. } = asked.color;
    let rounded = |channel: f32| ((f64::from(channel) * 1000.0).round() / 1000.0).to_string();
    let label = [red, green, blue].map(rounded).join(" ");
    vec![ColorPresentation { label, ..ColorPresentation::default() }]
}
