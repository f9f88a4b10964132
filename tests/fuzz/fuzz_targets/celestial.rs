#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| skyglow_tests::outside::celestial(bytes));
