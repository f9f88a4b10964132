//! Words that must not occur in some places.

use crate::tree::SourceFile;

/// A word and where it must not be written.
#[derive(Clone, Copy, Debug)]
pub struct ForbiddenWord {
    /// The word, matched literally.
    pub word: &'static str,
    /// Files that are looked at: their path starts with one of these.
    pub within: &'static [&'static str],
    /// Files that may write it: their path starts with one of these.
    pub except: &'static [&'static str],
    /// Why, for whoever breaks it.
    pub reason: &'static str,
}

/// Tests that generate entry points around the WGSL functions they compare, and broken shaders.
const WGSL_IN_TESTS: &[&str] =
    &["server/render/src/gpu/twin_tests.rs", "server/render/src/gpu/shader_tests.rs"];

/// What ARCHITECTURE.md forbids, as words in Rust or WGSL files.
pub const FORBIDDEN_WORDS: &[ForbiddenWord] = &[
    ForbiddenWord {
        word: "@compute",
        within: &["server/"],
        except: WGSL_IN_TESTS,
        reason: "WGSL text lives in shaders/, where it is validated and has its Rust twin",
    },
    ForbiddenWord {
        word: "@group(",
        within: &["server/", "shaders/lib/"],
        except: WGSL_IN_TESTS,
        reason: "bindings live in shaders/passes/",
    },
    ForbiddenWord {
        word: "wgpu::",
        within: &["server/"],
        except: &["server/render/"],
        reason: "only render names the device",
    },
    ForbiddenWord {
        word: "StatusCode",
        within: &["server/"],
        except: &["server/http/"],
        reason: "only http knows status codes",
    },
    ForbiddenWord {
        word: "axum::",
        within: &["server/"],
        except: &["server/http/"],
        reason: "only http names its framework",
    },
    ForbiddenWord {
        word: "skyglow_http",
        within: &["server/cli/src/"],
        except: &[
            "server/cli/src/commands/config.rs",
            "server/cli/src/commands/serve.rs",
            "server/cli/src/partial_settings.rs",
            "server/cli/src/settings.rs",
        ],
        reason: "commands other than serve and config answer without the interface",
    },
    ForbiddenWord {
        word: "gdal::",
        within: &["server/"],
        except: &["server/scene/", "server/observatory/tests/"],
        reason: "only scene reads rasters (tests may write some)",
    },
    ForbiddenWord {
        word: "std::fs",
        within: &["server/physics/src/"],
        except: &[],
        reason: "physics has no input or output",
    },
    ForbiddenWord { word: "static mut", within: &["server/"], except: &[], reason: "no global state" },
    ForbiddenWord {
        word: "std::env",
        within: &["server/physics/src/", "server/display/src/"],
        except: &[],
        reason: "pure functions do not read the environment",
    },
];

/// Where they occur all the same: path, line and reason.
pub fn violations(files: &[SourceFile], forbidden_words: &[ForbiddenWord]) -> Vec<String> {
    let mut found = Vec::new();
    for forbidden in forbidden_words {
        let starts = |file: &SourceFile, list: &[&str]| list.iter().any(|start| file.path.starts_with(start));
        for file in files.iter().filter(|f| starts(f, forbidden.within) && !starts(f, forbidden.except)) {
            for (index, line) in file.text.lines().enumerate() {
                if line.contains(forbidden.word) {
                    found.push(format!(
                        "{}:{}: {:?}: {}",
                        file.path,
                        index + 1,
                        forbidden.word,
                        forbidden.reason
                    ));
                }
            }
        }
    }
    found
}
