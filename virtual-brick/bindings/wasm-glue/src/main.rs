// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! `wasm-glue WASM FOLDER`: the JavaScript and type declarations beside a compiled module.
//!
//! The tool and the binding take the same version of wasm-bindgen from the workspace's lock file.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder] = arguments.as_slice() else {
        eprintln!("wasm-glue: expected the compiled module and the folder to write to");
        return ExitCode::from(2);
    };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(wasm).out_name("virtual_brick");
    bindgen.typescript(true).omit_default_module_path(false);
    bindgen
        .remove_producers_section(true)
        .remove_name_section(true);
    let written = bindgen
        .web(true)
        .and_then(|bindgen| bindgen.generate(folder));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("wasm-glue: {wasm}: {error:#}");
            ExitCode::FAILURE
        }
    }
}
