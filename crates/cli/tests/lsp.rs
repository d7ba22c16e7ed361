//! `dotray lsp` as an editor meets it: messages over standard input and output.

mod common;

use common::Folder;
use serde_json::Value;
use serde_json::json;
use std::io::BufRead;
use std::io::BufReader;
use std::io::Read;
use std::io::Write;
use std::process::Child;
use std::process::ChildStdin;
use std::process::ChildStdout;
use std::process::Command;
use std::process::Stdio;

/// The program, and an editor's end of the conversation.
struct Editor {
    program: Child,
    stdin: ChildStdin,
    stdout: BufReader<ChildStdout>,
    asked: i64,
    /// The messages about each file that came last.
    shown: std::collections::BTreeMap<String, Value>,
}

impl Editor {
    fn silent() -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_dotray"))
            .args(["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let stdin = program.stdin.take().expect("its input");
        let stdout = BufReader::new(program.stdout.take().expect("its output"));
        Self { program, stdin, stdout, asked: 0, shown: std::collections::BTreeMap::new() }
    }

    fn new() -> Self {
        let mut editor = Self::silent();
        let snippets = json!({ "completion": { "completionItem": { "snippetSupport": true } } });
        let params =
            json!({ "processId": null, "rootUri": null, "capabilities": { "textDocument": snippets } });
        let result = editor.ask("initialize", params);
        let able = &result["capabilities"];
        assert_eq!(able["positionEncoding"], "utf-16");
        for what in
            ["hoverProvider", "definitionProvider", "documentSymbolProvider", "documentFormattingProvider"]
        {
            assert_eq!(able[what], true, "{what}");
        }
        assert_eq!(result["serverInfo"]["name"], "dotray");
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.stdin, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("the program listens");
        self.stdin.flush().expect("the program listens");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// The next message; what it says about files is kept.
    fn hear(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.stdout.read_line(&mut line).expect("the program speaks") > 0,
                "the program has gone"
            );
            match line.trim_end().split_once(": ") {
                Some(("Content-Length", number)) => length = number.parse().expect("a length"),
                Some(_) => {}
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.stdout.read_exact(&mut body).expect("a whole message");
        let message: Value = serde_json::from_slice(&body).expect("JSON");
        if message["method"] == "textDocument/publishDiagnostics" {
            let uri = message["params"]["uri"].as_str().expect("an address").to_owned();
            self.shown.insert(uri, message["params"].clone());
        }
        message
    }

    /// The whole answer to a question.
    fn answer(&mut self, method: &str, params: Value) -> Value {
        self.asked += 1;
        let id = self.asked;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.hear();
            if message["id"] == id {
                return message;
            }
        }
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        let mut answer = self.answer(method, params);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].take()
    }

    fn open(&mut self, uri: &str, text: &str) {
        let item = json!({ "uri": uri, "languageId": "ray", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }));
    }

    /// The messages about this version of a file, once they come.
    fn messages(&mut self, uri: &str, version: i64) -> Vec<Value> {
        loop {
            if let Some(shown) = self.shown.get(uri)
                && shown["version"] == version
            {
                return shown["diagnostics"].as_array().expect("a list").clone();
            }
            self.hear();
        }
    }

    /// Asks about the place of the sign `|` in the text.
    fn ask_at(&mut self, method: &str, text: &str) -> Value {
        let uri = "untitled:at";
        let (line, column) = place(text);
        self.open(uri, &text.replacen('|', "", 1));
        let at = json!({ "line": line, "character": column });
        let result = self.ask(method, json!({ "textDocument": { "uri": uri }, "position": at }));
        self.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
        result
    }

    fn end(mut self) {
        assert_eq!(self.ask("shutdown", Value::Null), Value::Null);
        assert_eq!(self.answer("textDocument/hover", json!({}))["error"]["code"], -32600);
        self.tell("exit", Value::Null);
        assert_eq!(self.program.wait().expect("an end").code(), Some(0));
    }
}

/// The line and the column, in units of UTF-16, of the sign `|`.
fn place(text: &str) -> (usize, usize) {
    let before = text.split('|').next().expect("a place");
    let line = before.rsplit('\n').next().expect("a line");
    (before.matches('\n').count(), line.encode_utf16().count())
}

fn uri(folder: &Folder, name: &str) -> String {
    format!("file://{}", folder.path(name).canonicalize().expect("the file is there").display())
}

fn codes(messages: &[Value]) -> Vec<&str> {
    messages.iter().map(|message| message["code"].as_str().unwrap_or_default()).collect()
}

fn range(start: (u32, u32), end: (u32, u32)) -> Value {
    let at = |(line, character): (u32, u32)| json!({ "line": line, "character": character });
    json!({ "start": at(start), "end": at(end) })
}

#[test]
fn faults_are_shown_while_one_types() {
    let mut editor = Editor::new();
    let uri = "untitled:a";
    // The comment before the fault has two characters of two units each.
    editor.open(uri, "#light_dir 1 1 1 0 -1 0\n/* \u{1d11e}\u{e4}\u{1d11e} */ #shape_spere -1 0 0 0 1\n");
    let messages = editor.messages(uri, 1);
    assert_eq!(codes(&messages), ["unknown-directive"]);
    assert_eq!(messages[0]["range"], range((1, 12), (1, 24)));
    assert_eq!(messages[0]["severity"], 1);
    let text = messages[0]["message"].as_str().unwrap_or_default();
    assert!(text.contains("did you mean `#shape_sphere`?"), "{text}");
    let page = messages[0]["codeDescription"]["href"].as_str().unwrap_or_default();
    assert!(page.ends_with("docs/messages.md#unknown-directive"), "{page}");

    let action = json!({
        "textDocument": { "uri": uri },
        "range": range((1, 14), (1, 14)),
        "context": { "diagnostics": [] },
    });
    let actions = editor.ask("textDocument/codeAction", action);
    assert_eq!(actions[0]["edit"]["changes"][uri][0]["newText"], "#shape_sphere");

    // The repair, as the editor types it.
    let change = json!({ "range": messages[0]["range"], "text": "#shape_sphere" });
    let document = json!({ "uri": uri, "version": 2 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    assert_eq!(codes(&editor.messages(uri, 2)), ["no-camera"]);
    editor.end();
}

#[test]
fn open_texts_stand_for_files_and_parts_are_told_apart() {
    let folder = Folder::new();
    folder.put(
        "main.ray",
        b"#camera 0 0 4 0 0 -1 0 1 0 .5\n#light_dir 1 1 1 0 -1 0\n#ray_file part.ray\n#ray_file_instance 0\n",
    );
    folder.put("part.ray", b"#shape_sphere -1 0 0 0 1\n");
    let (main, part) = (uri(&folder, "main.ray"), uri(&folder, "part.ray"));
    let mut editor = Editor::new();
    editor.open(&main, &std::fs::read_to_string(folder.path("main.ray")).expect("text"));
    assert!(editor.messages(&main, 1).is_empty());
    // What is open counts, not what is on disk; a part needs neither camera nor lamps.
    editor.open(&part, "// \u{1d11e}\n#shape_sphere 7 0 0 0 1\n");
    let messages = editor.messages(&part, 1);
    assert_eq!(codes(&messages), ["unknown-material"]);
    assert_eq!(messages[0]["range"]["start"], json!({ "line": 1, "character": 14 }));
    let document = json!({ "uri": part, "version": 2 });
    let change = json!({ "textDocument": document, "contentChanges": [{ "text": "#group_begin 1 0" }] });
    editor.tell("textDocument/didChange", change);
    let messages = editor.messages(&part, 2);
    assert!(codes(&messages).contains(&"argument-count"), "{messages:?}");
    editor.end();
}

#[test]
fn what_may_come_next_is_offered() {
    let folder = Folder::new();
    let mut editor = Editor::new();
    let of = |items: &Value, label: &str| {
        let items = items.as_array().expect("a list");
        items
            .iter()
            .find(|item| item["label"] == label)
            .unwrap_or_else(|| panic!("no {label} in {items:?}"))
            .clone()
    };
    let items = editor.ask_at("textDocument/completion", "// \u{1d11e}\n/* \u{1d11e} */ #shape_s|");
    let item = of(&items, "#shape_sphere");
    assert_eq!(item["textEdit"]["newText"], "#shape_sphere ${1:m}  ${2:cx} ${3:cy} ${4:cz}  ${5:r}");
    assert_eq!(item["textEdit"]["range"], range((1, 9), (1, 17)));
    assert!(items.as_array().is_some_and(|items| items.len() > 20));
    // Before arguments that are there already only the word comes.
    let items = editor.ask_at("textDocument/completion", "#shape_s| 0 0 0 0 1");
    assert_eq!(of(&items, "#shape_sphere")["textEdit"]["newText"], "#shape_sphere");

    let material = "#material 1 1 1 1 1 1 1 1 1 1 1 1 0 0 1 -1 ";
    let items = editor.ask_at("textDocument/completion", &format!("{material}!!\n#shape_sphere |"));
    assert!(of(&items, "0")["detail"].as_str().is_some_and(|detail| detail.starts_with("#material 1 1 1")));
    assert_eq!(of(&items, "-1")["detail"], "the default material");
    let items = editor.ask_at("textDocument/completion", &format!("{material}!wo|!"));
    assert_eq!(of(&items, "wood")["textEdit"]["range"], range((0, 44), (0, 46)));
    let items = editor.ask_at("textDocument/completion", &format!("{material}!noise; wood sc|\n"));
    assert_eq!(of(&items, "scale")["textEdit"]["newText"], "scale=");
    let items = editor.ask_at("textDocument/completion", "#camera 1 // #sha|");
    assert_eq!(items, json!([]));

    folder.put("wood.png", b"");
    let scene = uri(&folder, "balls.ray");
    editor.open(&scene, "#texture w\n#ray_file b");
    let at = |line: u32, character: u32| {
        let position = json!({ "line": line, "character": character });
        json!({ "textDocument": { "uri": scene }, "position": position })
    };
    let images = editor.ask("textDocument/completion", at(0, 10));
    assert_eq!(images.as_array().map(Vec::len), Some(1), "{images}");
    assert_eq!(images[0]["label"], "wood.png");
    let scenes = editor.ask("textDocument/completion", at(1, 11));
    of(&scenes, "balls.ray");
    editor.end();
}

#[test]
fn each_number_has_a_meaning() {
    let mut editor = Editor::new();
    let cases = [
        ("#camera 0 0 4 0 0 -1 0 1 0 .5|23", "**`ha`**, a number: half of the vertical view angle"),
        ("#camera 0 0 4 0 0 -1 0 1 0 .5|23", "= 29.97°"),
        ("#camera 0 0 4 0 0 -1 0 1 0 .5|23", "Argument 10 of 10"),
        ("#cam|era 0 0", "The eye and where it looks."),
        ("/* \u{1d11e} */ #shape_sphere 0 0 0 0 2|", "radius (scene units)"),
        ("#shape_sphere 0 0 0 0 2 3|", "One argument more than `#shape_sphere` takes."),
        ("#material 1 2 3\n#material 4 5\n#shape_sphere 1| 0 0 0 1", "#material 4 5"),
        ("#shape_sphere 9| 0 0 0 1", "Names nothing"),
        ("#material 1\n#mate|rial 2", "material number 1 of this file"),
        ("#texture nowhere|.png", "There is no such file."),
    ];
    for (text, part) in cases {
        let hover = editor.ask_at("textDocument/hover", text);
        let value = hover["contents"]["value"].as_str().unwrap_or_default();
        assert!(value.contains(part), "{text}: {value}");
    }
    assert_eq!(editor.ask_at("textDocument/hover", "// #cam|era"), Value::Null);
    let help = editor.ask_at("textDocument/signatureHelp", "#shape_cone 0 0 0 |");
    assert_eq!(help["activeParameter"], 3);
    assert_eq!(help["signatures"][0]["label"], "#shape_cone m cx cy cz r h");
    assert_eq!(help["signatures"][0]["parameters"][3]["label"], json!([20, 22]));
    editor.end();
}

#[test]
fn names_lead_to_what_they_name() {
    let folder = Folder::new();
    folder.put("two words.png", b"");
    let mut editor = Editor::new();
    let scene = uri(&folder, "balls.ray");
    let lines = [
        "// \u{1d11e}",
        "#texture \"two words.png\"",
        "#ray_file wrong.ray",
        "/* \u{1d11e} */ #material 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 0 !!",
        "#vertex 0 0 0 0 0 1 0 0",
        "#vertex 1 0 0 0 0 1 0 0",
        "#shape_triangle 0 0 1 1",
        "#ray_file_instance 0",
    ];
    editor.open(&scene, &lines.join("\n"));
    let mut go = |line: u32, character: u32| {
        let at = json!({ "line": line, "character": character });
        editor.ask("textDocument/definition", json!({ "textDocument": { "uri": scene }, "position": at }))
    };
    let start = |line: u32, character: u32| json!({ "line": line, "character": character });
    assert!(go(1, 12)["uri"].as_str().is_some_and(|uri| uri.ends_with("/two%20words.png")));
    assert_eq!(go(2, 12)["uri"], uri(&folder, "wrong.ray").as_str());
    assert_eq!(go(3, 49)["range"]["start"], start(1, 0));
    assert_eq!(go(6, 16)["range"]["start"], start(3, 9));
    assert_eq!(go(6, 18)["range"]["start"], start(4, 0));
    assert_eq!(go(6, 20)["range"]["start"], start(5, 0));
    assert_eq!(go(7, 20)["range"]["start"], start(2, 0));
    assert_eq!(go(4, 10), Value::Null);
    let document = json!({ "textDocument": { "uri": scene } });
    let links = editor.ask("textDocument/documentLink", document.clone());
    assert_eq!(links.as_array().map(Vec::len), Some(2), "{links}");
    let colors = editor.ask("textDocument/documentColor", document);
    assert_eq!(colors.as_array().map(Vec::len), Some(4), "{colors}");
    editor.end();
}

#[test]
fn the_outline_shows_groups_and_their_shapes() {
    let mut editor = Editor::new();
    let vertices = "#vertex 0 0 0 0 0 1 0 0\n".repeat(1000);
    let text = format!(
        "#camera 0 0 4 0 0 -1 0 1 0 .5\n#material 1 2 3 4 5 6\n#group_begin 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n\
         #shape_sphere 0 0 0 0 1\n#group_begin\n#shape_box 0\n#group_end\n#group_end\n{vertices}#group_end\n"
    );
    editor.open("untitled:o", &text);
    let document = json!({ "textDocument": { "uri": "untitled:o" } });
    let outline = editor.ask("textDocument/documentSymbol", document);
    let names = |list: &Value| -> Vec<String> {
        let list = list.as_array().expect("a list");
        list.iter().map(|symbol| symbol["name"].as_str().unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(names(&outline), ["camera", "material 0", "group", "vertex × 1000"]);
    assert_eq!(outline[1]["detail"], "4 5 6");
    assert_eq!(outline[2]["detail"], "at 5 6 7");
    assert_eq!(outline[2]["range"], range((2, 0), (7, 10)));
    assert_eq!(names(&outline[2]["children"]), ["sphere", "group"]);
    assert_eq!(names(&outline[2]["children"][1]["children"]), ["box"]);
    editor.end();
}

#[test]
fn texts_are_laid_out() {
    let mut editor = Editor::new();
    let uri = "untitled:f";
    let ask = json!({ "textDocument": { "uri": uri }, "options": { "tabSize": 4, "insertSpaces": true } });
    editor.open(uri, "// \u{1d11e}\n#Ambient 1   1 1\n#background 0 0 0\n");
    let edits = editor.ask("textDocument/formatting", ask.clone());
    assert_eq!(edits, json!([{ "range": range((1, 0), (2, 0)), "newText": "#ambient 1 1 1\n" }]));
    editor.open(uri, "#ambient 1 1 1\n");
    assert_eq!(editor.ask("textDocument/formatting", ask.clone()), json!([]));
    editor.open(uri, "#ambient 1 1\n");
    assert_eq!(editor.ask("textDocument/formatting", ask), Value::Null);
    editor.end();
}

#[test]
fn nothing_that_is_said_or_written_ends_the_conversation() {
    let mut editor = Editor::new();
    let uri = "untitled:x";
    assert_eq!(editor.answer("no/such", json!({}))["error"]["code"], -32601);
    assert_eq!(editor.answer("textDocument/hover", json!([1]))["error"]["code"], -32602);
    editor.tell("textDocument/didOpen", json!({ "what": 1 }));
    editor.tell("no/such", json!(null));
    let deep = format!(
        "{}{}",
        "#group_begin 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ".repeat(30_000),
        "#group_end ".repeat(30_000)
    );
    let texts = [
        "",
        "\u{feff}",
        "!",
        "\"",
        "/*",
        "#",
        "# #material !",
        "#material ! ;; = \u{1d11e}=!",
        "\0\u{fffd}\r\r\n",
        &deep,
    ];
    for text in texts {
        editor.open(uri, text);
        let whole = json!({ "uri": uri });
        for (line, character) in
            [(0, 0), (0, 1), (0, 7), (0, 4_000_000_000_u32), (4_000_000_000_u32, 0), (1, 3)]
        {
            let at = json!({ "textDocument": whole, "position": { "line": line, "character": character } });
            for method in ["hover", "completion", "definition", "signatureHelp"] {
                editor.ask(&format!("textDocument/{method}"), at.clone());
            }
        }
        for method in ["documentSymbol", "documentLink", "documentColor", "formatting"] {
            let options = json!({ "tabSize": 4, "insertSpaces": true });
            editor
                .ask(&format!("textDocument/{method}"), json!({ "textDocument": whole, "options": options }));
        }
        editor.messages(uri, 1);
        editor.shown.clear();
    }
    editor.end();
}

#[test]
fn a_very_large_text_is_refused_and_not_waited_for() {
    let mut editor = Editor::new();
    let uri = "untitled:large";
    let started = std::time::Instant::now();
    editor.open(uri, &"#shape_sphere -1 0 0 0 1\n".repeat(2_100_000));
    let messages = editor.messages(uri, 1);
    assert_eq!(messages.len(), 1);
    let text = messages[0]["message"].as_str().unwrap_or_default();
    assert!(text.contains("50 MiB") && text.contains("dotray check"), "{text}");
    let change = json!({ "range": range((0, 0), (2_099_999, 0)), "text": "" });
    let document = json!({ "uri": uri, "version": 2 });
    editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
    assert_eq!(codes(&editor.messages(uri, 2)), ["no-light", "no-camera"]);
    // Generous for the sake of busy machines: a hang is longer.
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
    editor.end();
}

#[test]
fn an_editor_that_goes_without_a_word_is_no_reason_to_stay() {
    let Editor { mut program, stdin, stdout, .. } = Editor::new();
    drop((stdin, stdout));
    assert_eq!(program.wait().expect("an end").code(), Some(1));
    let mut editor = Editor::new();
    editor.tell("exit", Value::Null);
    assert_eq!(editor.program.wait().expect("an end").code(), Some(1));
    let mut editor = Editor::silent();
    editor.stdin.write_all(b"Content-Length: many\r\n\r\n").expect("the program listens");
    assert_eq!(editor.program.wait().expect("an end").code(), Some(1));
}
