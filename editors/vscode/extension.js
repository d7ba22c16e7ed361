// Starts `dotray lsp` and connects it with the editor.
"use strict";

const vscode = require("vscode");
const { LanguageClient, TransportKind } = require("vscode-languageclient/node");

let client;

async function start() {
  const settings = vscode.workspace.getConfiguration("dotray");
  const command = settings.get("path", "dotray");
  const args = ["lsp", "--dialect", settings.get("dialect", "auto")];
  const server = { command, args, transport: TransportKind.stdio };
  const documents = {
    documentSelector: [{ language: "ray" }],
    synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/*.{ray,bmp,png,jpg,ppm}") },
  };
  client = new LanguageClient("dotray", "dotray", server, documents);
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    vscode.window.showErrorMessage(
      `The program \`${command}\` does not start (${error.message}). Install dotray, or set dotray.path.`
    );
  }
}

async function stop() {
  const running = client;
  client = undefined;
  await running?.stop();
}

exports.activate = async (context) => {
  const restart = async () => {
    await stop();
    await start();
  };
  context.subscriptions.push(
    vscode.commands.registerCommand("dotray.restart", restart),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("dotray")) {
        return restart();
      }
    })
  );
  await start();
};

exports.deactivate = stop;
