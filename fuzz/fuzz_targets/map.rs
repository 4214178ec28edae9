#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| neuralmls_fuzz::check_map(bytes));
