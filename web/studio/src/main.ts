// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
/** Start: the page around the editor, which is loaded beside it. */
import { Server } from "./server";
import { Studio } from "./studio";
import "../../src/style/base.css";
import "./style.css";

const place = document.getElementById("studio");
if (!place) throw new Error("index.html has no element #studio");

const studio = new Studio(place, new Server());
await studio.begin();
