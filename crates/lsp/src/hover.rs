//! What the word under the cursor means, and which argument comes next.

use crate::complete::grown;
use crate::complete::shown;
use crate::documents::Document;
use crate::refer::Named;
use crate::refer::existing;
use crate::refer::named;
use crate::refer::number_of;
use crate::refer::target;
use crate::spot::On;
use crate::spot::Spot;
use crate::statement::Statement;
use crate::statement::slice;
use crate::text::Text;
use crate::words::about;
use crate::words::meaning;
use crate::words::usage;
use dotray_scene::directive::Arguments;
use dotray_scene::directive::Directive;
use dotray_scene::directive::Spec;
use lsp_types::Documentation;
use lsp_types::Hover;
use lsp_types::HoverContents;
use lsp_types::MarkupContent;
use lsp_types::MarkupKind;
use lsp_types::ParameterInformation;
use lsp_types::ParameterLabel;
use lsp_types::Position;
use lsp_types::SignatureHelp;
use lsp_types::SignatureInformation;

/// What the word at a place means.
pub fn hover(document: &Document, position: Position) -> Option<Hover> {
    if document.is_too_large() {
        return None;
    }
    let bytes = &document.bytes;
    let text = Text::new(bytes);
    let spot = Spot::new(bytes, text.offset(position));
    let statement = spot.statement.as_ref()?;
    let token = spot.token()?;
    let value = match spot.on {
        On::Word => of_word(document, statement)?,
        On::Argument(index) => of_argument(document, &spot, statement, index)?,
        On::Nothing | On::Comment | On::Gap(_) | On::Open(..) => return None,
    };
    let contents = HoverContents::Markup(MarkupContent { kind: MarkupKind::Markdown, value });
    Some(Hover { contents, range: Some(text.range(token.start, token.end)) })
}

/// What is named by its number.
const COUNTED: [(Directive, &str); 4] = [
    (Directive::Material, "material"),
    (Directive::Texture, "texture"),
    (Directive::Vertex, "vertex"),
    (Directive::RayFile, "included file"),
];

fn of_word(document: &Document, statement: &Statement) -> Option<String> {
    let Document { bytes, dialect, .. } = document;
    let spec = statement.spec(bytes, *dialect)?;
    let about = about(spec);
    let Some((_, counted)) = COUNTED.into_iter().find(|(directive, _)| *directive == spec.directive) else {
        return Some(format!("**`{}`** {about}", spec.word));
    };
    let number = number_of(bytes, *dialect, spec.directive, statement);
    Some(format!("**`{}`**, {counted} number {number} of this file. {about}", spec.word))
}

fn of_argument(document: &Document, spot: &Spot, statement: &Statement, index: usize) -> Option<String> {
    let Document { bytes, dialect, path, .. } = document;
    let spec = statement.spec(bytes, *dialect)?;
    let named = named(bytes, path, *dialect, spot);
    let described = match statement.argument(bytes, spec, index) {
        Some((name, group)) => {
            let form = statement.form(bytes, spec)?;
            let place = index + 1 - statement.flags(bytes);
            let line = usage(spec, form);
            let what = meaning(name, group);
            let value = statement.arguments.get(index).map(|token| slice(bytes, *token));
            let value = value.and_then(|value| in_degrees(value, group)).unwrap_or_default();
            format!("{what}{value}\n\nArgument {place} of {}:\n```ray\n{line}\n```", form.count)
        }
        None if index < statement.flags(bytes) => "A flag of the directive.".to_owned(),
        None => return Some(format!("One argument more than `{}` takes.", spec.word)),
    };
    let further = match &named {
        Some(Named::File(places)) => match existing(places) {
            Some(path) => format!("\n\nThe file `{}`.", path.display()),
            None => "\n\nThere is no such file.".to_owned(),
        },
        Some(other) => match target(bytes, *dialect, other) {
            Some(target) => format!("\n\nNames\n```ray\n{}\n```", shown(bytes, &target)),
            None => "\n\nNames nothing in this file.".to_owned(),
        },
        None => String::new(),
    };
    Some(described + &further)
}

/// What an angle in radians is in degrees.
fn in_degrees(value: &[u8], group: &Arguments) -> Option<String> {
    let radians: f64 = std::str::from_utf8(value).ok()?.parse().ok()?;
    let degrees = radians * (180.0 / std::f64::consts::PI);
    (group.unit == "radians" && degrees.is_finite()).then(|| format!(" = {degrees:.2}°"))
}

/// The forms of the directive at a place, and the argument that the cursor is at.
pub fn signatures(document: &Document, position: Position) -> Option<SignatureHelp> {
    if document.is_too_large() {
        return None;
    }
    let Document { bytes, dialect, .. } = document;
    let spot = Spot::new(bytes, Text::new(bytes).offset(position));
    let statement = spot.statement.as_ref()?;
    let spec = statement.spec(bytes, *dialect)?;
    let (index, wanted) = match spot.on {
        On::Argument(index) => (index, statement.form(bytes, spec)?),
        On::Gap(index) => (index, grown(statement).form(bytes, spec)?),
        On::Nothing | On::Comment | On::Word | On::Open(..) => return None,
    };
    let index = index.checked_sub(statement.flags(bytes))?;
    if index >= wanted.count {
        return None;
    }
    let active = spec.forms.iter().position(|form| form.count == wanted.count)?;
    let signatures =
        spec.forms.iter().enumerate().map(|(number, _)| signature(spec, number, index)).collect();
    Some(SignatureHelp {
        signatures,
        active_signature: u32::try_from(active).ok(),
        active_parameter: u32::try_from(index).ok(),
    })
}

fn signature(spec: &'static Spec, number: usize, index: usize) -> SignatureInformation {
    let mut label = spec.word.to_owned();
    let mut parameters = Vec::new();
    for (name, group) in spec.forms.get(number).into_iter().flat_map(|form| form.each()) {
        label.push(' ');
        // The table's names are ASCII, so bytes are units of UTF-16.
        let start = u32::try_from(label.len()).unwrap_or(u32::MAX);
        label.push_str(name);
        let end = u32::try_from(label.len()).unwrap_or(u32::MAX);
        let value = meaning(name, group);
        let documentation = MarkupContent { kind: MarkupKind::Markdown, value };
        parameters.push(ParameterInformation {
            label: ParameterLabel::LabelOffsets([start, end]),
            documentation: Some(Documentation::MarkupContent(documentation)),
        });
    }
    SignatureInformation {
        label,
        documentation: Some(Documentation::String(spec.meaning.to_owned())),
        parameters: Some(parameters),
        active_parameter: u32::try_from(index).ok(),
    }
}
