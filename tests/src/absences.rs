//! Words that must not occur in some places.

use crate::tree::SourceFile;

/// A word and where it must not be written.
#[derive(Clone, Copy, Debug)]
pub struct Absence {
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

/// The absences of ARCHITECTURE.md that are words in Rust or WGSL files.
pub const ABSENCES: &[Absence] = &[
    Absence {
        word: "@compute",
        within: &["server/"],
        except: WGSL_IN_TESTS,
        reason: "WGSL text lives in shaders/, where it is validated and has its Rust twin",
    },
    Absence {
        word: "@group(",
        within: &["server/", "shaders/lib/"],
        except: WGSL_IN_TESTS,
        reason: "bindings live in shaders/passes/",
    },
    Absence {
        word: "wgpu::",
        within: &["server/"],
        except: &["server/render/"],
        reason: "only render names the device",
    },
    Absence {
        word: "StatusCode",
        within: &["server/"],
        except: &["server/http/"],
        reason: "only http knows status codes",
    },
    Absence {
        word: "axum::",
        within: &["server/"],
        except: &["server/http/"],
        reason: "only http names its framework",
    },
    Absence {
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
    Absence {
        word: "gdal::",
        within: &["server/"],
        except: &["server/scene/", "server/observatory/tests/"],
        reason: "only scene reads rasters (tests may write some)",
    },
    Absence {
        word: "std::fs",
        within: &["server/physics/src/"],
        except: &[],
        reason: "physics has no input or output",
    },
    Absence { word: "static mut", within: &["server/"], except: &[], reason: "no global state" },
    Absence {
        word: "std::env",
        within: &["server/physics/src/", "server/display/src/"],
        except: &[],
        reason: "pure functions do not read the environment",
    },
];

/// Where `absences` do not hold: path, line and reason.
pub fn violations(files: &[SourceFile], absences: &[Absence]) -> Vec<String> {
    let mut found = Vec::new();
    for absence in absences {
        let starts = |file: &SourceFile, list: &[&str]| list.iter().any(|start| file.path.starts_with(start));
        for file in files.iter().filter(|f| starts(f, absence.within) && !starts(f, absence.except)) {
            for (index, line) in file.text.lines().enumerate() {
                if line.contains(absence.word) {
                    found.push(format!(
                        "{}:{}: {:?}: {}",
                        file.path,
                        index + 1,
                        absence.word,
                        absence.reason
                    ));
                }
            }
        }
    }
    found
}
