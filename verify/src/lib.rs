pub mod files;
pub mod scene;
pub mod study;
