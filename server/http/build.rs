//! Builds again when the viewer's built form changes.

fn main() {
    println!("cargo:rerun-if-changed=../../web/dist");
}
