// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** The page's address: which project it shows, and how. */

export interface Place {
  /** Folder with session, image and sources, ending with a slash. */
  folder: string;
  /** The page is one of many projects of a site. */
  shared: boolean;
  /** Small, in a frame of another page. */
  embedded: boolean;
  /** The run begins by itself. */
  runs: boolean;
  /** Name of the project where the page is shown, "" for its own. */
  name: string;
}

const NAME = /^[a-z0-9][a-z0-9_-]*$/;

/** `?brick=NAME` is the folder bricks/NAME beside the page's folder; other names are not taken. */
export function placeOf({ search }: { search: string }): Place {
  const options = new URLSearchParams(search);
  const brick = options.get("brick") ?? "";
  const shared = NAME.test(brick);
  const shownAs = options.get("as") ?? "";
  const folder = shared ? `../bricks/${brick}/` : "./";
  return {
    folder,
    shared,
    embedded: options.has("embed"),
    runs: options.has("run"),
    name: NAME.test(shownAs) ? shownAs : "",
  };
}
