// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Colours of Ada and of project files: the lexical elements of the Ada Reference Manual, 2. */
import { StreamLanguage, type StringStream } from "@codemirror/language";

// Ada Reference Manual 2012, 2.9.
const RESERVED = new Set(
  (
    "abort abs abstract accept access aliased all and array at begin body case constant " +
    "declare delay delta digits do else elsif end entry exception exit for function " +
    "generic goto if in interface is limited loop mod new not null of or others out " +
    "overriding package pragma private procedure project protected raise range record rem " +
    "renames requeue return reverse select separate some subtype synchronized tagged task " +
    "terminate then type until use when while with xor"
  ).split(" "),
);
const WORD = /^[A-Za-z][A-Za-z0-9_]*/;
const NUMBER = /^\d[\d_]*(#[0-9a-fA-F_.]+#)?(\.\d[\d_]*)?([eE][+-]?\d+)?/;

function token(stream: StringStream): string | null {
  if (stream.eatSpace()) return null;
  if (stream.match("--")) {
    stream.skipToEnd();
    return "comment";
  }
  if (stream.match(/^"([^"]|"")*"?/)) return "string";
  // An attribute's tick stands behind a name, a character's quotes stand around one character.
  if (stream.match(/^'.'/)) return "string";
  if (stream.match(NUMBER)) return "number";
  const word = stream.match(WORD) as RegExpMatchArray | null;
  if (word) return RESERVED.has(word[0].toLowerCase()) ? "keyword" : "variableName";
  stream.next();
  return null;
}

export const ada = StreamLanguage.define({
  name: "ada",
  token,
  languageData: { commentTokens: { line: "--" } },
});
