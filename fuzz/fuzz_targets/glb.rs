#![no_main]

use neuralmls_shapes::Format;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| neuralmls_fuzz::check(bytes, Format::Glb));
