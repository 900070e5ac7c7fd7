// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The editor (CodeMirror): one view, a state for each open file; loaded beside the page. */
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { cpp } from "@codemirror/lang-cpp";
import { python } from "@codemirror/lang-python";
import {
  bracketMatching,
  HighlightStyle,
  indentOnInput,
  StreamLanguage,
  syntaxHighlighting,
} from "@codemirror/language";
import { toml } from "@codemirror/legacy-modes/mode/toml";
import { lintGutter, lintKeymap, setDiagnostics, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { EditorState, type Extension, type Text } from "@codemirror/state";
import {
  drawSelection,
  EditorView,
  highlightActiveLine,
  highlightActiveLineGutter,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { ada } from "./ada";
import type { FileText, Problem } from "./server";

const LANGUAGES: Record<string, () => Extension> = {
  python,
  c: cpp,
  ada: () => ada,
  toml: () => StreamLanguage.define(toml),
};

const HIGHLIGHT = HighlightStyle.define([
  { tag: tags.keyword, color: "var(--code-keyword)" },
  { tag: [tags.string, tags.character], color: "var(--code-string)" },
  { tag: [tags.number, tags.bool, tags.atom], color: "var(--code-number)" },
  { tag: tags.comment, color: "var(--soft)", fontStyle: "italic" },
  { tag: [tags.heading, tags.propertyName], color: "var(--accent)" },
]);

export interface EditorActions {
  save(): void;
  leave(): void;
  edited(path: string): void;
}

interface Open {
  state: EditorState;
  saved: Text;
  version: string | null;
}

export class Editor {
  private readonly view: EditorView;
  private readonly open = new Map<string, Open>();
  path = "";

  constructor(
    parent: HTMLElement,
    private readonly actions: EditorActions,
  ) {
    this.view = new EditorView({ parent, state: EditorState.create() });
    this.view.dom.hidden = true;
    // Its scroll bar can be reached by keyboard where the text in it has the focus.
    this.view.scrollDOM.tabIndex = 0;
  }

  has(path: string): boolean {
    return this.open.has(path);
  }

  /** Show a file; the one before keeps its cursor and its changes. */
  show(path: string): void {
    const file = this.open.get(path);
    if (!file) return;
    this.keep();
    this.path = path;
    this.view.dom.hidden = false;
    this.view.setState(file.state);
  }

  /** Take a file from the server, in place of what was open under its name. */
  put(file: FileText): void {
    const state = EditorState.create({ doc: file.text, extensions: this.extensions(file) });
    const at = this.path === file.path ? this.view.state.selection.main.head : 0;
    this.open.set(file.path, { state, saved: state.doc, version: file.version });
    if (this.path !== file.path) return;
    this.view.setState(state);
    this.view.dispatch({ selection: { anchor: Math.min(at, state.doc.length) } });
  }

  forget(path: string): void {
    this.open.delete(path);
  }

  focus(): void {
    this.view.focus();
  }

  /** Whether a file has changes that were not saved. */
  dirty(path: string): boolean {
    const file = this.open.get(path);
    return file !== undefined && !this.stateOf(path).doc.eq(file.saved);
  }

  dirtyPaths(): string[] {
    return [...this.open.keys()].filter((path) => this.dirty(path));
  }

  openPaths(): string[] {
    return [...this.open.keys()];
  }

  /** Text, and the version that it was made from. */
  text(path: string): { text: string; version: string | null; doc: Text } {
    const state = this.stateOf(path);
    const version = this.open.get(path)?.version ?? null;
    return { text: state.sliceDoc(), version, doc: state.doc };
  }

  /** This text is on the disk, as this version. */
  saved(path: string, doc: Text, version: string): void {
    const file = this.open.get(path);
    if (file) Object.assign(file, { saved: doc, version });
  }

  /** The disk has this version, which the next save replaces. */
  supersede(path: string, version: string | null): void {
    const file = this.open.get(path);
    if (file) file.version = version;
  }

  /** Mark errors at their lines in the file that is shown. */
  mark(problems: readonly Problem[]): void {
    const { doc } = this.view.state;
    const here = problems.filter(({ file }) => file === this.path);
    const diagnostics = here.map(({ line, column, message }): Diagnostic => {
      const { from, to, text } = doc.line(Math.min(Math.max(line, 1), doc.lines));
      const first = from + (text.length - text.trimStart().length);
      const at = column > 0 ? Math.min(from + column - 1, to) : first;
      return { from: at, to, severity: "error", message };
    });
    this.view.dispatch(setDiagnostics(this.view.state, diagnostics));
  }

  /** Put the cursor at a place, counted from 1, and look there. */
  go(line: number, column: number): void {
    const { doc } = this.view.state;
    const { from, to } = doc.line(Math.min(Math.max(line, 1), doc.lines));
    const anchor = Math.min(from + Math.max(column - 1, 0), to);
    this.view.dispatch({
      selection: { anchor },
      effects: EditorView.scrollIntoView(anchor, { y: "center" }),
    });
    this.view.focus();
  }

  private keep(): void {
    const file = this.open.get(this.path);
    if (file) file.state = this.view.state;
  }

  private stateOf(path: string): EditorState {
    return path === this.path ? this.view.state : this.open.get(path)!.state;
  }

  private extensions(file: FileText): Extension {
    const own = keymap.of([
      { key: "Mod-s", run: () => (this.actions.save(), true), preventDefault: true },
      { key: "Escape", run: () => (this.actions.leave(), true) },
    ]);
    const readOnly = file.read_only ? ", read-only" : "";
    const windows = file.text.includes("\r\n") ? EditorState.lineSeparator.of("\r\n") : [];
    return [
      lineNumbers(),
      highlightActiveLine(),
      highlightActiveLineGutter(),
      drawSelection(),
      history(),
      indentOnInput(),
      bracketMatching(),
      highlightSelectionMatches(),
      search({ top: true }),
      lintGutter(),
      syntaxHighlighting(HIGHLIGHT),
      LANGUAGES[file.language]?.() ?? [],
      windows,
      EditorState.tabSize.of(file.language === "ada" ? 3 : 4),
      EditorState.readOnly.of(file.read_only !== ""),
      EditorView.contentAttributes.of({ "aria-label": file.path + readOnly }),
      keymap.of([...searchKeymap, ...lintKeymap, ...historyKeymap, indentWithTab]),
      own,
      keymap.of(defaultKeymap),
      EditorView.updateListener.of((update) => {
        if (update.docChanged) this.actions.edited(this.path);
      }),
    ];
  }
}
