//! Readers of foreign files: surfaces, label maps, images, node clouds, and their writers.

pub mod files;
