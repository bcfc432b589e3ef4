//! Tells the build scripts of the crates above where the sources of this solver lie: what they
//! store of its results is keyed by a fingerprint of these. Cargo passes this on for packages
//! with `links`, as `DEP_MTLED_SOURCES`.

fn main() {
    let folder = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    println!("cargo::metadata=sources={folder}/src");
    // With its folder: of a checkout that was moved, or of another that shares this target
    // folder, the file is gone, and Cargo runs this anew.
    println!("cargo::rerun-if-changed={folder}/build.rs");
}
