//! Adds sources behind skylines to packs that were made without, of this format or the one before; their basis and open
//! tables stay bit for bit.
//!
//! `add_blocked OUT [AXES.json] PACK...`: packs that differ in turbidity alone, together; goes on from what a killed run
//! left in OUT, which may be their own folder. `make_packs.sh` makes the same packs from nothing. Other axes than those
//! of the program (as `blocked` in a manifest) are for trying them.

use skyglow_tables::{BlockedAxes, Progress, add_blocked};
use std::{
    error::Error,
    path::{Path, PathBuf},
    sync::Mutex,
    time::Instant,
};

/// Says how long each stage took.
struct Stages(Mutex<(String, Instant)>);

impl Stages {
    fn end(&self, next: &str) {
        if let Ok(mut stage) = self.0.lock() {
            println!("{:8.1} s  {}", stage.1.elapsed().as_secs_f64(), stage.0);
            *stage = (next.to_owned(), Instant::now());
        }
    }
}

impl Progress for Stages {
    fn begin(&self, stage: &str, steps: u64) {
        self.end(&format!("{stage}, {steps} steps"));
    }

    fn advance(&self, _steps: u64) {}
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, out, packs @ ..] = arguments.as_slice() else {
        return Err("usage: add_blocked OUT [AXES.json] PACK...".into());
    };
    let (axes, packs) = match packs {
        [axes, packs @ ..] if axes.ends_with(".json") => {
            (serde_json::from_slice(&std::fs::read(axes)?)?, packs)
        }
        packs => (BlockedAxes::full(), packs),
    };
    let packs: Vec<PathBuf> = packs.iter().map(PathBuf::from).collect();
    let stages = Stages(Mutex::new(("reading".to_owned(), Instant::now())));
    let paths = add_blocked(&packs, Some(&axes), Path::new(out), &stages)?;
    stages.end("");
    for path in paths {
        println!("{}: {} bytes", path.display(), std::fs::metadata(&path)?.len());
    }
    Ok(())
}
