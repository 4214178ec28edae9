//! `neuralmls-bindgen MODULE.wasm FOLDER`: what `wasm-bindgen --target web` does, without names and producers.
//!
//! The module and this program must have one version of wasm-bindgen. In one workspace they cannot have two, since
//! both need the same `wasm-bindgen-shared`.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [module, folder] = arguments.as_slice() else {
        eprintln!("neuralmls-bindgen: expected a WebAssembly module and a folder");
        return ExitCode::from(2);
    };
    let mut bindgen = Bindgen::new();
    bindgen.input_path(module).remove_name_section(true).remove_producers_section(true).typescript(true);
    match bindgen.web(true).and_then(|web| web.generate(folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("neuralmls-bindgen: {}: {error:#}", module.display());
            ExitCode::FAILURE
        }
    }
}
